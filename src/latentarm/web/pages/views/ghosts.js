/** Predictions for each direction: paths of the tool over the next second, drawn in both views. */

import * as THREE from "../three/three.module.min.js";
import { colour } from "./colours.js";
import { DIRECTION_NAMES } from "../inputs/deflection.js";
import { ROUND } from "./fineness.js";
import { merged } from "./merged.js";
import { MARKS } from "./predictions.js";

/** @import {Labels} from "./labels.js" */

/** @typedef {ReturnType<typeof drawn>} Ghost */

const THICK_M = 0.006;
/** A path shorter than this, m, is not drawn. */
const SHORT_M = 0.006;
const BEADS = 9;
const HEAD = new THREE.ConeGeometry(0.016, 0.034, 10);
const NO_COLOUR = new THREE.Color();
const CLEAR = 0.95;
const STEPPED_BACK = 0.3;

export class Ghosts {
  /** @param {THREE.Scene} scene @param {Labels} labels */
  constructor(scene, labels) {
    this._labels = labels;
    this._ghosts = DIRECTION_NAMES.map(drawn);
    for (const { body, head, beads } of this._ghosts) scene.add(body, head, beads);
    this.repaint();
  }

  repaint() {
    for (const { direction, material } of this._ghosts) material.color.set(colour(`ghost-${direction}`));
  }

  /**
   * @param {Paths} paths for the person's own directions
   * @param {Direction[]} pressed the directions that are pressed now; the others step back
   * @param {boolean} shown
   * @param {number} share how much of them is to be seen, in [0, 1]: near what is wanted they would cover it
   */
  show(paths, pressed, shown, share) {
    for (const ghost of this._ghosts) {
      const path = paths[ghost.direction];
      const visible = shown && path !== null && lengthOf(path) > SHORT_M;
      ghost.body.visible = visible && isUpright(ghost.direction);
      ghost.beads.visible = visible && !isUpright(ghost.direction);
      ghost.head.visible = ghost.beads.visible;
      const clear = pressed.length === 0 || pressed.includes(ghost.direction);
      ghost.material.opacity = share * (clear ? CLEAR : STEPPED_BACK);
      this._labels.set(`ghost-${ghost.direction}`, visible ? this._lay(ghost, path) : null,
        MARKS[ghost.direction], { shown: visible, ghost: ghost.direction, opacity: share });
    }
  }

  /** Up and down are tubes, left and right are beads; all end in a cone. @param {Ghost} ghost @param {number[][]} path */
  _lay({ direction, body, beads, head }, path) {
    const points = path.map(([x, y, z]) => new THREE.Vector3(x, y, z));
    const curve = new THREE.CatmullRomCurve3(points);
    const end = curve.getPoint(1);
    const ahead = curve.getTangent(1);
    head.position.copy(end).addScaledVector(ahead, 0.012);
    head.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), ahead);
    if (isUpright(direction)) {
      head.updateMatrix();
      const tube = new THREE.TubeGeometry(curve, 10, THICK_M, 5);
      body.geometry.dispose();
      body.geometry = merged([
        { geometry: tube, at: new THREE.Matrix4(), colour: NO_COLOUR },
        { geometry: HEAD, at: head.matrix, colour: NO_COLOUR },
      ]);
    } else {
      for (let bead = 0; bead < BEADS; bead += 1) {
        const { x, y, z } = curve.getPoint(bead / (BEADS - 1));
        beads.setMatrixAt(bead, new THREE.Matrix4().makeTranslation(x, y, z));
      }
      beads.instanceMatrix.needsUpdate = true;
    }
    return end.addScaledVector(ahead, 0.05);
  }
}

/** The objects that draw one path. @param {Direction} direction */
function drawn(direction) {
  const material = new THREE.MeshBasicMaterial({ transparent: true, depthTest: false });
  /** @type {THREE.Mesh} */
  const body = new THREE.Mesh(new THREE.BufferGeometry(), material);
  const head = new THREE.Mesh(HEAD, material);
  const beads = new THREE.InstancedMesh(new THREE.IcosahedronGeometry(0.0075, ROUND.divided), material, BEADS);
  beads.frustumCulled = body.frustumCulled = false;
  for (const object of [body, head, beads]) {
    object.renderOrder = 2;
    object.visible = false;
  }
  return { direction, material, body, head, beads };
}

/** @param {Direction} direction */
function isUpright(direction) {
  return direction === "up" || direction === "down";
}

/** @param {number[][]} path */
function lengthOf(path) {
  return path.slice(1).reduce((sum, to, from) => sum + Math.hypot(...to.map((end, axis) => end - path[from][axis])), 0);
}
