/** Where the cameras look from: as near as holds the whole scene, or close to the tool and what it is to do something with. */

import * as THREE from "../three/three.module.min.js";

/** @import {View} from "./views.js" */

export const FOV_DEG = 32;
/** Room around the outermost points: the arm is thick. */
const MARGIN_M = 0.13;
/** So far out, as a share of half a view, the tool is about to leave it. */
const EDGE = 0.92;
/** The small view is close from one distance on, until another, m, with so much room about what is seen. */
const NEAR_M = 0.2;
const FAR_M = 0.27;
const CLOSE_MARGIN_M = 0.045;
/** It stays as it is while the outermost point is between these shares of half of it. */
const CLOSE_FILLED = [0.45, 0.9];

/** Where each camera looks from, as directions from the middle of the scene. @type {Record<string, Record<"front" | "side", [number, number, number]>>} */
const DIRECTIONS = {
  facing: { front: [1, 0, 0.42], side: [0.08, -1, 0.22] },
  behind: { front: [-1, -0.55, 0.75], side: [0.08, -1, 0.22] },
  flat: { front: [0, -0.01, 1], side: [0, -1, 0.8] },
};

export class Aim {
  /** @param {ArmScene} scene */
  constructor(scene) {
    this._scene = scene;
    /** @type {"facing" | "behind"} */
    this.seat = "facing";
    /** @type {THREE.Vector3[]} Where the tool was when it would have left a view, m: cameras hold these too. */
    this._reached = [];
    /** The tool, what it is to do something with, and where its arrows lead, m. @type {THREE.Vector3[]} */
    this._near = [];
    /** Whether the small view is close. */
    this.close = false;
  }

  /** The tool is somewhere else altogether: forget where it has been. */
  forget() {
    this._reached = [];
  }

  /** Come close, where the first two of these are near each other. @param {THREE.Vector3[]} points m; none for never @returns {boolean} whether that is new */
  approach(points) {
    const was = this.close;
    this._near = points;
    this.close = points.length > 1 && points[0].distanceTo(points[1]) < (was ? FAR_M : NEAR_M);
    return this.close !== was;
  }

  /** @param {View[]} views the largest first */
  turn(views) {
    const points = [...this._scene.extent(), ...this._reached];
    const size = new THREE.Box3().setFromPoints(points).getSize(new THREE.Vector3());
    const flat = size.z < 0.1 * Math.max(size.x, size.y);
    const directions = DIRECTIONS[flat ? "flat" : this.seat];
    for (const [index, view] of views.entries()) {
      if (this.close && index > 0) fit(view, this._near, directions[view.name], CLOSE_MARGIN_M);
      else fit(view, points, directions[view.name], MARGIN_M);
    }
  }

  /** Turn again where a point would leave a view, or what is close has become small. @param {View[]} views the largest first */
  follow(views) {
    const [least, most] = CLOSE_FILLED;
    const { tool } = this._scene;
    const moved = views.filter((view, index) => {
      const close = this.close && index > 0;
      const out = outermost(view, close ? this._near : [tool]);
      if (!close && out >= EDGE) this._reached.push(tool.clone());
      return close ? out < least || out > most : out >= EDGE;
    });
    if (moved.length) this.turn(views);
  }
}

/** How far out the outermost of these is, as a share of half the view. @param {View} view @param {THREE.Vector3[]} points m */
function outermost({ camera }, points) {
  return Math.max(...points.map((point) => {
    const { x, y } = point.clone().project(camera);
    return Math.max(Math.abs(x), Math.abs(y));
  }));
}

/** @param {View} view @param {THREE.Vector3[]} points m @param {[number, number, number]} direction from the points to the camera @param {number} margin m */
function fit({ camera, width, height }, points, direction, margin) {
  const away = new THREE.Vector3(...direction).normalize();
  const right = new THREE.Vector3(0, 0, 1).cross(away).normalize();
  const up = away.clone().cross(right);
  const tall = Math.tan((FOV_DEG * Math.PI) / 360);
  const [across, along] = [right, up].map((axis) => {
    const values = points.map((point) => point.dot(axis));
    return (Math.min(...values) + Math.max(...values)) / 2;
  });
  camera.aspect = width / height;
  const nearest = Math.max(...points.map((point) => point.dot(away) + Math.max(
    (Math.abs(point.dot(right) - across) + margin) / (tall * camera.aspect),
    (Math.abs(point.dot(up) - along) + margin) / tall,
  )));
  camera.position.copy(right.multiplyScalar(across).addScaledVector(up, along).addScaledVector(away, nearest));
  camera.lookAt(camera.position.clone().sub(away));
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld();
}
