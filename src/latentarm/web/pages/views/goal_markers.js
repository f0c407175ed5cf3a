/**
 * The goals. About each thing that may be meant there is a ring, as large as the robot's belief in it; a dashed ring
 * over it is where the tool is to come to. Each goal has a shape and a colour of its own.
 */

import * as THREE from "../three/three.module.min.js";
import { colour } from "./colours.js";
import { Dashes } from "./dashes.js";
import { colourOf, shapeOf } from "./symbols.js";

/** @import {Goal} from "./scene_description.js" */

const HOVER_M = 0.024;
const HOVER_DASHES = 8;
const LINE_DASHES = 32;

export class GoalMarkers {
  /** @param {Goal[]} goals @param {(goal: Goal) => THREE.Vector3 | null} placeOf its thing now; null for a place alone @param {number} tableHeight m */
  constructor(goals, placeOf, tableHeight) {
    this._goals = goals;
    this._placeOf = placeOf;
    this._rings = goals.map((goal, index) => ring(index));
    this._dashes = new Dashes(goals.length * (HOVER_DASHES + LINE_DASHES));
    for (const { position } of goals) {
      const hover = new THREE.Vector3(...position);
      this._dashes.begin();
      this._dashes.ring(hover, HOVER_M, HOVER_DASHES);
      this._dashes.line(hover, new THREE.Vector3(hover.x, hover.y, tableHeight), LINE_DASHES);
    }
    this.objects = [...this._rings, this._dashes.object];
    this.follow();
    this.repaint();
  }

  /** Where a goal is marked, m: at its thing. @param {number} index */
  placeOf(index) {
    const goal = this._goals[index];
    return this._placeOf(goal) ?? new THREE.Vector3(...goal.position);
  }

  follow() {
    this._rings.forEach((one, index) => one.position.copy(this.placeOf(index)));
  }

  /** How sure the robot is of each goal: the size of its ring. @param {number[] | null} belief */
  believe(belief) {
    this._rings.forEach((one, index) => {
      const share = belief?.[index] ?? 0;
      one.visible = belief !== null;
      one.scale.setScalar(0.03 + 0.05 * share);
      one.material.opacity = 0.5 + 0.5 * share;
    });
  }

  repaint() {
    this._rings.forEach((one, index) => one.material.color.set(colour(`thing-${colourOf(index)}`)));
    this._dashes.paint(this._goals.map((_, index) => colour(`thing-${colourOf(index)}`)));
  }
}

/** A ring of a goal's shape, which faces whichever view is being drawn. @param {number} index */
function ring(index) {
  const { corners, turn } = shapeOf(index);
  const made = new THREE.Mesh(new THREE.TorusGeometry(1, 0.08, 3, corners), new THREE.MeshBasicMaterial({ transparent: true }));
  const turned = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 0, 1), turn);
  made.onBeforeRender = (_renderer, _scene, camera) => {
    made.quaternion.copy(camera.quaternion).multiply(turned);
    made.updateMatrixWorld(true);
  };
  return made;
}
