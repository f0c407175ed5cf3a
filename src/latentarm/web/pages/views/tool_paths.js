/** The paths of the tools along a motion, each an arrow in both views. */

import * as THREE from "../three/three.module.min.js";
import { colour } from "./colours.js";
import { ballOf } from "./shapes.js";

const THICK_M = 0.009;

export class ToolPaths {
  /** @param {THREE.Scene} scene */
  constructor(scene) {
    this._scene = scene;
    this._material = new THREE.MeshBasicMaterial({ depthTest: false, transparent: true, opacity: 0.95 });
    /** @type {THREE.Mesh[]} */
    this._drawn = [];
    this.repaint();
  }

  repaint() {
    this._material.color.set(colour("way"));
  }

  /** @param {[number, number, number][][]} paths points of each tool, m */
  show(paths) {
    for (const object of this._drawn) {
      this._scene.remove(object);
      object.geometry.dispose();
    }
    this._drawn = paths.flatMap((path) => this._arrow(path.map((point) => new THREE.Vector3(...point))));
    if (this._drawn.length) this._scene.add(...this._drawn);
  }

  /** @param {THREE.Vector3[]} points */
  _arrow(points) {
    const start = new THREE.Mesh(ballOf(0.017), this._material);
    start.position.copy(points[0]);
    /** @type {THREE.Mesh[]} */
    const parts = [start];
    if (points[0].distanceTo(points[points.length - 1]) > 1e-3) {
      const curve = new THREE.CatmullRomCurve3(points);
      parts.push(new THREE.Mesh(new THREE.TubeGeometry(curve, 24, THICK_M, 8), this._material));
      const head = new THREE.Mesh(new THREE.ConeGeometry(0.028, 0.055, 14), this._material);
      const ahead = curve.getTangent(1);
      head.position.copy(curve.getPoint(1)).addScaledVector(ahead, 0.016);
      head.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), ahead);
      parts.push(head);
    }
    for (const one of parts) one.renderOrder = 3;
    return parts;
  }
}
