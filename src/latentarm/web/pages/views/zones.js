/** Where the arm is slow: solids that can be seen through, with their outlines; a plane is a sheet. */

import * as THREE from "../three/three.module.min.js";
import { colour } from "./colours.js";
import { sheetOf, solidOf } from "./shapes.js";

/** @import {Zone} from "./scene_description.js" */

const CALM = { solid: 0.1, outline: 0.5 };
const SLOWING = { solid: 0.28, outline: 1 };
/** How much of a plane is drawn. */
const SHEET_M = 1;
/** Edges between faces that meet at more than this are drawn, degrees. */
const EDGE_DEG = 1;

export class Zones {
  /** @param {Zone[]} zones */
  constructor(zones) {
    /** Names, speeds in m/s, what is drawn, and where the names are written. */
    this.all = zones.map((zone) => {
      const material = new THREE.MeshBasicMaterial({ transparent: true, depthWrite: false, side: THREE.DoubleSide });
      const solid = zone.type === "plane" ? sheetOf(zone, SHEET_M, material) : solidOf(zone, material);
      const outline = new THREE.LineSegments(
        new THREE.EdgesGeometry(solid.geometry, EDGE_DEG),
        new THREE.LineBasicMaterial({ transparent: true, depthWrite: false }),
      );
      solid.add(outline);
      const { min, max } = new THREE.Box3().setFromObject(solid);
      return { name: zone.name, speed: zone.speed, solid, outline, top: new THREE.Vector3((min.x + max.x) / 2, (min.y + max.y) / 2, max.z) };
    });
    this.objects = this.all.map(({ solid }) => solid);
    this.slow(null);
  }

  /** Mark the zone that slows the arm. @param {string | null} slowing its name */
  slow(slowing) {
    for (const { name, solid, outline } of this.all) {
      const look = name === slowing ? SLOWING : CALM;
      solid.material.opacity = look.solid;
      outline.material.opacity = look.outline;
    }
  }

  repaint() {
    for (const { solid, outline } of this.all) {
      solid.material.color.set(colour("warn"));
      outline.material.color.set(colour("warn"));
    }
  }
}
