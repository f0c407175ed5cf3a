/** Dashed lines in three dimensions: thick enough to be seen from everywhere, and one call to draw all of them. */

import * as THREE from "../three/three.module.min.js";

/** From the middle of a dash to its three edges. */
const THICK_M = 0.0021;
const DASH_M = 0.012;
const EVERY_M = 0.022;
const AHEAD = new THREE.Vector3(0, 0, 1);

export class Dashes {
  /** @param {number} most how many dashes there can be */
  constructor(most) {
    this._most = most;
    const dash = new THREE.CylinderGeometry(THICK_M, THICK_M, DASH_M, 3, 1, true).rotateX(Math.PI / 2);
    this.object = new THREE.InstancedMesh(dash, new THREE.MeshBasicMaterial(), most);
    this.object.frustumCulled = false;
    this.object.count = 0;
    /** At which dash each drawing begins. @type {number[]} */
    this._begins = [];
  }

  /** What follows has a colour of its own. */
  begin() {
    this._begins.push(this.object.count);
  }

  /** A level ring. @param {THREE.Vector3} middle @param {number} radius m @param {number} dashes */
  ring(middle, radius, dashes) {
    for (let dash = 0; dash < dashes; dash += 1) {
      const angle = (2 * Math.PI * dash) / dashes;
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      this._add(new THREE.Vector3(middle.x + radius * cos, middle.y + radius * sin, middle.z), new THREE.Vector3(-sin, cos, 0));
    }
  }

  /** A line, of no more dashes than these. @param {THREE.Vector3} from @param {THREE.Vector3} to @param {number} dashes */
  line(from, to, dashes) {
    const along = to.clone().sub(from);
    const end = Math.min(along.length(), DASH_M / 2 + dashes * EVERY_M);
    along.normalize();
    for (let at = DASH_M / 2; at < end; at += EVERY_M) this._add(from.clone().addScaledVector(along, at), along);
  }

  /** @param {string[]} colours of each drawing, in the order in which they were begun */
  paint(colours) {
    colours.forEach((colour, index) => {
      const painted = new THREE.Color(colour);
      const end = this._begins[index + 1] ?? this.object.count;
      for (let dash = this._begins[index]; dash < end; dash += 1) this.object.setColorAt(dash, painted);
    });
    if (this.object.instanceColor) this.object.instanceColor.needsUpdate = true;
  }

  /** @param {THREE.Vector3} at @param {THREE.Vector3} along */
  _add(at, along) {
    if (this.object.count >= this._most) return;
    const turned = new THREE.Quaternion().setFromUnitVectors(AHEAD, along);
    this.object.setMatrixAt(this.object.count, new THREE.Matrix4().compose(at, turned, new THREE.Vector3(1, 1, 1)));
    this.object.count += 1;
    this.object.instanceMatrix.needsUpdate = true;
  }
}
