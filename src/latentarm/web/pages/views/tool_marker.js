/** The tool as a dot, with a plumb line down to the table or to what stands under it. */

import * as THREE from "../three/three.module.min.js";
import { colour } from "./colours.js";
import { ballOf } from "./shapes.js";

export class ToolMarker {
  constructor() {
    this._dot = new THREE.Mesh(ballOf(0.014), new THREE.MeshBasicMaterial());
    const line = new THREE.CylinderGeometry(0.0022, 0.0022, 1, 6).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    this._plumb = new THREE.Mesh(line, new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.55 }));
    this._foot = new THREE.Mesh(new THREE.RingGeometry(0.016, 0.022, 24), new THREE.MeshBasicMaterial());
    this.object = new THREE.Group().add(this._dot, this._plumb, this._foot);
  }

  /** @param {THREE.Vector3} tool m @param {number} height of what is under it, m */
  moveTo(tool, height) {
    this._dot.position.copy(tool);
    this._plumb.position.set(tool.x, tool.y, height);
    this._plumb.scale.z = Math.max(tool.z - height, 1e-3);
    this._foot.position.set(tool.x, tool.y, height + 0.002);
  }

  repaint() {
    for (const part of [this._dot, this._plumb, this._foot]) part.material.color.set(colour("tool"));
  }
}
