/** Where the tool has been: beads along its path, the oldest replaced first. */

import { THREE } from "../three/index.js";
import { colour } from "./colours.js";

const MOST = 600;
const STEP_M = 0.008;

export class Trail {
  constructor() {
    this._material = new THREE.MeshBasicMaterial();
    this.object = new THREE.InstancedMesh(new THREE.OctahedronGeometry(0.0045), this._material, MOST);
    this.object.frustumCulled = false;
    this._next = 0;
    /** @type {THREE.Vector3 | null} */
    this._end = null;
    this.clear();
  }

  /** @param {THREE.Vector3} tool m */
  extend(tool) {
    if (this._end && this._end.distanceTo(tool) < STEP_M) return;
    this._end = tool.clone();
    this.object.setMatrixAt(this._next, new THREE.Matrix4().makeTranslation(tool.x, tool.y, tool.z));
    this.object.instanceMatrix.needsUpdate = true;
    this._next = (this._next + 1) % MOST;
    this.object.count = Math.max(this.object.count, this._next);
  }

  clear() {
    this.object.count = 0;
    this._next = 0;
    this._end = null;
  }

  repaint() {
    this._material.color.set(colour("trail"));
  }
}
