/** Dashed lines in three dimensions: thick enough to be seen from everywhere, and one call to draw. */

import { THREE } from "../three/index.js";

const THICK_M = 0.0035;
const DASH_M = 0.012;
const EVERY_M = 0.022;
const AHEAD = new THREE.Vector3(0, 0, 1);

export class Dashes {
  /** @param {THREE.MeshBasicMaterial} material @param {number} most how many dashes there can be */
  constructor(material, most) {
    this._most = most;
    this.object = new THREE.InstancedMesh(new THREE.BoxGeometry(THICK_M, THICK_M, DASH_M), material, most);
    this.object.frustumCulled = false;
    this.object.count = 0;
  }

  clear() {
    this.object.count = 0;
  }

  /** A level ring. @param {THREE.Vector3} middle @param {number} radius m @param {number} dashes */
  ring(middle, radius, dashes) {
    for (let dash = 0; dash < dashes; dash += 1) {
      const angle = (2 * Math.PI * dash) / dashes;
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      this._add(new THREE.Vector3(middle.x + radius * cos, middle.y + radius * sin, middle.z), new THREE.Vector3(-sin, cos, 0));
    }
  }

  /** A line; what there is no dash left for is not drawn. @param {THREE.Vector3} from @param {THREE.Vector3} to */
  line(from, to) {
    const along = to.clone().sub(from);
    const length = along.length();
    along.normalize();
    for (let at = DASH_M / 2; at < length; at += EVERY_M) this._add(from.clone().addScaledVector(along, at), along);
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
