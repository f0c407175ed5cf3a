/** Where every direction of the stick leads: a ring through where the tool would be, drawn in both views. */

import * as THREE from "../three/three.module.min.js";
import { directionPaint } from "./colours.js";
import { merged } from "./merged.js";

const THICK_M = 0.0028;
/** One in so many points has a pin, which shows how the tool would be turned there. */
const PINNED = 4;
const PIN_M = 0.045;
const PIN_WIDE_M = 0.026;
const PIN_THICK_M = 0.0019;
const CLEAR = 0.9;
const AHEAD = new THREE.Vector3(0, 0, 1);
const UNSCALED = new THREE.Vector3(1, 1, 1);

export class Ring {
  /** @param {THREE.Scene} scene */
  constructor(scene) {
    this._scene = scene;
    this._material = new THREE.MeshBasicMaterial({ transparent: true, depthTest: false });
    /** @type {{lines: THREE.InstancedMesh, pins: THREE.InstancedMesh} | null} */
    this._drawn = null;
  }

  repaint() {
    if (this._drawn) paint(this._drawn.lines, this._drawn.pins);
  }

  /** @param {number[][]} ring x, y, z (m), quaternion w, x, y, z, all round the stick @param {boolean} shown @param {number} share to be seen, in [0, 1] */
  show(ring, shown, share) {
    const visible = shown && ring.length > 0;
    if (visible) this._lay(ring);
    if (this._drawn) this._drawn.lines.visible = this._drawn.pins.visible = visible;
    this._material.opacity = CLEAR * share;
  }

  /** @param {number[][]} ring */
  _lay(ring) {
    this._drawn ??= this._make(ring.length);
    const { lines, pins } = this._drawn;
    const points = ring.map(([x, y, z]) => new THREE.Vector3(x, y, z));
    points.forEach((from, index) => {
      const along = points[(index + 1) % points.length].clone().sub(from);
      const long = along.length();
      const turned = new THREE.Quaternion().setFromUnitVectors(AHEAD, along.normalize());
      lines.setMatrixAt(index, new THREE.Matrix4().compose(from, turned, new THREE.Vector3(1, 1, long)));
      if (index % PINNED) return;
      const [w, x, y, z] = ring[index].slice(3);
      pins.setMatrixAt(index / PINNED, new THREE.Matrix4().compose(from, new THREE.Quaternion(x, y, z, w), UNSCALED));
    });
    lines.instanceMatrix.needsUpdate = pins.instanceMatrix.needsUpdate = true;
  }

  /** @param {number} count of the directions */
  _make(count) {
    const line = new THREE.CylinderGeometry(THICK_M, THICK_M, 1, 4, 1, true).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    const lines = new THREE.InstancedMesh(line, this._material, count);
    const pins = new THREE.InstancedMesh(pin(), this._material, count / PINNED);
    for (const object of [lines, pins]) {
      object.frustumCulled = false;
      object.renderOrder = 1;
      this._scene.add(object);
    }
    paint(lines, pins);
    return { lines, pins };
  }
}

/** Its tip is at the tool, its stem goes back along the tool's axis, and its bar lies as the fingers do. */
function pin() {
  const stem = new THREE.CylinderGeometry(PIN_THICK_M, PIN_THICK_M, PIN_M, 4).rotateX(Math.PI / 2).translate(0, 0, -PIN_M / 2);
  const bar = new THREE.CylinderGeometry(PIN_THICK_M, PIN_THICK_M, PIN_WIDE_M, 4).translate(0, 0, -PIN_M);
  const at = new THREE.Matrix4();
  return merged([stem, bar].map((geometry) => ({ geometry, at, colour: new THREE.Color("white") })));
}

/** As the rim of the stick is. @param {THREE.InstancedMesh} lines @param {THREE.InstancedMesh} pins */
function paint(lines, pins) {
  for (let line = 0; line < lines.count; line += 1) {
    const painted = new THREE.Color(directionPaint(line / lines.count));
    lines.setColorAt(line, painted);
    if (line % PINNED === 0) pins.setColorAt(line / PINNED, painted);
  }
  for (const { instanceColor } of [lines, pins]) if (instanceColor) instanceColor.needsUpdate = true;
}
