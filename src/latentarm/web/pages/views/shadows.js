/** Soft shadows on what is under the arm and the things: a dark spot under each, the wider the higher it is. */

import * as THREE from "../three/three.module.min.js";

const DISC_PX = 64;
const DARKEST = 0.24;
/** A spot is wider by this share of the height. */
const SPREAD = 0.12;
/** Above what it lies on, m. */
const RAISED_M = 0.0015;

export class Shadows {
  /** @param {number} most how many spots there can be */
  constructor(most) {
    const material = new THREE.MeshBasicMaterial({ map: spot(), transparent: true, depthWrite: false });
    this.object = new THREE.InstancedMesh(new THREE.PlaneGeometry(2, 2), material, most);
    this.object.frustumCulled = false;
    this.object.renderOrder = -1;
    this.object.count = 0;
  }

  /** @param {{at: THREE.Vector3, radius: number, floor: number}[]} under what there is, how wide it is, and the height of what is under it, m */
  show(under) {
    const turned = new THREE.Quaternion();
    under.forEach(({ at, radius, floor }, index) => {
      const size = radius + SPREAD * Math.max(at.z - floor, 0);
      const place = new THREE.Vector3(at.x, at.y, floor + RAISED_M);
      this.object.setMatrixAt(index, new THREE.Matrix4().compose(place, turned, new THREE.Vector3(size, size, 1)));
    });
    this.object.count = under.length;
    this.object.instanceMatrix.needsUpdate = true;
  }
}

/** Dark in the middle, and clear at the edge. */
function spot() {
  const canvas = new OffscreenCanvas(DISC_PX, DISC_PX);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const middle = DISC_PX / 2;
  const shade = context.createRadialGradient(middle, middle, 0, middle, middle, middle);
  shade.addColorStop(0, `rgb(0 0 0 / ${DARKEST})`);
  shade.addColorStop(0.45, `rgb(0 0 0 / ${DARKEST / 2})`);
  shade.addColorStop(1, "rgb(0 0 0 / 0)");
  context.fillStyle = shade;
  context.fillRect(0, 0, DISC_PX, DISC_PX);
  return new THREE.CanvasTexture(canvas);
}
