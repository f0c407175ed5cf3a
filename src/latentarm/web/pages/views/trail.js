/** Where the tool has been: dots along its path, the oldest replaced first. */

import * as THREE from "../three/three.module.min.js";
import { colour } from "./colours.js";

const MOST = 600;
const STEP_M = 0.008;
const SIZE_PX = 3.5;
const DISC_PX = 32;

export class Trail {
  constructor() {
    this._places = new THREE.BufferAttribute(new Float32Array(3 * MOST), 3);
    const geometry = new THREE.BufferGeometry().setAttribute("position", this._places);
    this._material = new THREE.PointsMaterial({ size: SIZE_PX, sizeAttenuation: false, map: disc(), alphaTest: 0.5 });
    this.object = new THREE.Points(geometry, this._material);
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
    this._places.setXYZ(this._next, tool.x, tool.y, tool.z);
    this._places.needsUpdate = true;
    this._next = (this._next + 1) % MOST;
    const { drawRange } = this.object.geometry;
    drawRange.count = Math.max(drawRange.count, this._next);
  }

  clear() {
    this._next = 0;
    this._end = null;
    this.object.geometry.drawRange.count = 0;
  }

  repaint() {
    this._material.color.set(colour("trail"));
  }
}

/** A point is a square: this makes it round. */
function disc() {
  const canvas = new OffscreenCanvas(DISC_PX, DISC_PX);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.fillStyle = "white";
  context.arc(DISC_PX / 2, DISC_PX / 2, DISC_PX / 2, 0, 2 * Math.PI);
  context.fill();
  return new THREE.CanvasTexture(canvas);
}
