/** The table with its grid of 10 cm, and what else the arm must keep clear of. */

import * as THREE from "../three/three.module.min.js";
import { colour } from "./colours.js";
import { sheetOf, solidOf } from "./shapes.js";

/** @import {Obstacle} from "./scene_description.js" */

const SIZE_M = 1.6;
const MIDDLE_M = 0.35;
const CELL_M = 0.1;

export class Table {
  /** @param {Obstacle[]} obstacles a level plane is drawn as the table, others as sheets */
  constructor(obstacles) {
    const look = { transparent: true, opacity: 0.6 };
    const level = obstacles.find((one) => one.type === "plane" && one.normal[2] > 0.99);
    this._solids = obstacles.filter((one) => one !== level).map((one) => {
      const material = new THREE.MeshLambertMaterial({ ...look, side: one.type === "plane" ? THREE.DoubleSide : THREE.FrontSide });
      return one.type === "plane" ? sheetOf(one, SIZE_M, material) : solidOf(one, material);
    });
    /** m */
    this.height = level?.type === "plane" ? level.point[2] : 0;
    this._floor = new THREE.Mesh(new THREE.PlaneGeometry(SIZE_M, SIZE_M), new THREE.MeshBasicMaterial());
    this._floor.position.set(MIDDLE_M, 0, this.height - 0.002);
    const half = SIZE_M / 2;
    const points = [];
    for (let at = -half; at < half + 1e-6; at += CELL_M) points.push(at, -half, 0, at, half, 0, -half, at, 0, half, at, 0);
    const lines = new THREE.BufferGeometry();
    lines.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
    this._grid = new THREE.LineSegments(lines, new THREE.LineBasicMaterial());
    this._grid.position.set(MIDDLE_M, 0, this.height);
    this.objects = [this._floor, this._grid, ...this._solids];
  }

  repaint() {
    this._floor.material.color.set(colour("table"));
    this._grid.material.color.set(colour("grid"));
    for (const solid of this._solids) solid.material.color.set(colour("table"));
  }
}
