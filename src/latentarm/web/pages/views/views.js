/** Two cameras on one scene: front and side, drawn on one canvas, only when something has changed. */

import * as THREE from "../three/three.module.min.js";
import { SOFTWARE } from "./fineness.js";

const FOV_DEG = 32;
/** Room around the outermost points: the arm is thick, and labels are next to goals. */
const MARGIN_M = 0.13;
/** How often a frame's end is checked, ms. */
const LOOK_MS = 8;
/** Frames may hold others up for so long, ms, less what each frame in time takes back; then the drawing gets coarser. */
const MOST_HELD_MS = 640;
const TAKEN_BACK_MS = 16;
const COARSEST = 0.5;
const LONGEST_COMPILING_MS = 3000;
/** So far out, as a share of half a view, the tool is about to leave it. */
const EDGE = 0.92;
/** Without a graphics processor, pixels are dear from the start. */
const SOFTWARE_SHARE = 0.7;

/** Work for the next frame waits no longer than this, ms. */
const SOON_MS = 120;

/** @import {ArmScene} from "./scene.js" */

/** Where each camera looks from, as directions from the middle of the scene. @type {Record<string, Record<"front" | "side", [number, number, number]>>} */
const DIRECTIONS = {
  facing: { front: [1, 0, 0.42], side: [0.08, -1, 0.22] },
  behind: { front: [-1, -0.55, 0.75], side: [0.08, -1, 0.22] },
  flat: { front: [0, -0.01, 1], side: [0, -1, 0.8] },
};

/**
 * @typedef {object} View
 * @property {"front" | "side"} name
 * @property {HTMLElement} element
 * @property {HTMLElement} labels
 * @property {THREE.PerspectiveCamera} camera
 * @property {number} left of its left lower corner on the canvas, px
 * @property {number} bottom
 * @property {number} width px
 * @property {number} height
 */

export class Views {
  /**
   * @param {HTMLCanvasElement} canvas lies under both views
   * @param {{front: HTMLElement, side: HTMLElement}} elements
   * @param {ArmScene} scene
   */
  constructor(canvas, elements, scene) {
    this._canvas = canvas;
    this._scene = scene;
    /** Whether there is time for frames between two states. */
    this.smooth = !SOFTWARE;
    this._renderer = new THREE.WebGLRenderer({ canvas, antialias: !SOFTWARE, alpha: true, powerPreference: "low-power" });
    this._renderer.setScissorTest(true);
    this._ratio = Math.min(devicePixelRatio, 2) * (SOFTWARE ? SOFTWARE_SHARE : 1);
    /** @type {WebGL2RenderingContext} */
    this._gl = /** @type {WebGL2RenderingContext} */ (this._renderer.getContext());
    /** @type {WebGLSync | null} Passed by the graphics processor when the last frame is done. */
    this._fence = null;
    this._heldMs = 0;
    this._pending = false;
    /** Whether the page shows it. */
    this._shown = true;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this._soon = undefined;
    /** @type {"facing" | "behind"} */
    this.seat = "facing";
    /** @type {View[]} */
    this.views = /** @type {("front" | "side")[]} */ (["front", "side"]).map((name) => ({
      name,
      element: elements[name],
      labels: /** @type {HTMLElement} */ (elements[name].querySelector(".labels")),
      camera: new THREE.PerspectiveCamera(FOV_DEG, 1, 0.05, 20),
      left: 0, bottom: 0, width: 0, height: 0,
    }));
    for (const view of this.views) view.camera.up.set(0, 0, 1);
    /** @type {THREE.Vector3[]} Where the tool was when it would have left a view, m: cameras hold these too. */
    this._reached = [];
    /** @type {(() => void)[]} Called before each frame, to move labels. */
    this.beforeFrame = [];
    /** @type {(() => void)[]} Called after each frame. */
    this.afterFrame = [];
    const observer = new ResizeObserver(() => this.layOut());
    for (const one of [canvas, ...this.views.map(({ element }) => element)]) observer.observe(one);
    document.addEventListener("visibilitychange", () => this.invalidate());
  }

  /** Compile what is drawn with, while the page goes on: the first frame would hold up inputs for that. */
  async prepare() {
    const { scene } = this._scene;
    const was = scene.visible;
    scene.visible = true;
    const compiled = this._renderer.compileAsync(scene, this.views[0].camera);
    scene.visible = was;
    await Promise.race([compiled, new Promise((resolve) => setTimeout(resolve, LONGEST_COMPILING_MS))]);
  }

  /** Something has changed: draw with the next frame; at once, as soon as all of it is known, where each frame takes long. */
  invalidate() {
    if (this._pending || document.hidden || !this._shown) return;
    this._pending = true;
    if (this.smooth) requestAnimationFrame(() => this._frame());
    else queueMicrotask(() => this._frame());
  }

  /**
   * Something has changed that may be drawn with whatever changes next, where each frame takes long.
   *
   * @param {boolean} expected whether the arm is about to move: a frame that is under way then would hold its first one up
   */
  invalidateSoon(expected) {
    if (this.smooth) {
      this.invalidate();
      return;
    }
    if (expected) {
      clearTimeout(this._soon);
      this._soon = undefined;
    }
    this._soon ??= setTimeout(() => this.invalidate(), SOON_MS);
  }

  /** The tool is somewhere else altogether: forget where it has been. */
  forget() {
    this._reached = [];
    this.layOut();
  }

  /** Fit the canvas and the cameras to the page. */
  layOut() {
    const box = this._canvas.getBoundingClientRect();
    this._shown = Boolean(box.width && box.height);
    if (!this._shown) return;
    this._renderer.setPixelRatio(this._ratio);
    this._renderer.setSize(box.width, box.height, false);
    for (const view of this.views) {
      const { element } = view;
      const place = element.getBoundingClientRect();
      view.left = place.left - box.left + element.clientLeft;
      view.bottom = box.bottom - place.bottom + element.clientTop;
      view.width = element.clientWidth;
      view.height = element.clientHeight;
    }
    this._aim();
    this.invalidate();
  }

  /**
   * Where a point is in a view, CSS pixels from its left upper corner.
   *
   * @param {View} view
   * @param {THREE.Vector3} point
   */
  project(view, point) {
    const seen = point.clone().project(view.camera);
    return { x: ((seen.x + 1) / 2) * view.width, y: ((1 - seen.y) / 2) * view.height };
  }

  /** The views for which the page has room. */
  get _seen() {
    return this.views.filter(({ width, height }) => width > 0 && height > 0);
  }

  /** Turn both cameras to the scene, as near as holds all of it. */
  _aim() {
    const points = [...this._scene.extent(), ...this._reached];
    const size = new THREE.Box3().setFromPoints(points).getSize(new THREE.Vector3());
    const flat = size.z < 0.1 * Math.max(size.x, size.y);
    const directions = DIRECTIONS[flat ? "flat" : this.seat];
    for (const view of this._seen) {
      const aspect = view.width / view.height;
      const away = new THREE.Vector3(...directions[view.name]).normalize();
      const right = new THREE.Vector3(0, 0, 1).cross(away).normalize();
      const up = away.clone().cross(right);
      const tall = Math.tan((FOV_DEG * Math.PI) / 360);
      const [across, along] = [right, up].map((axis) => middleOf(points.map((point) => point.dot(axis))));
      let nearest = -Infinity;
      for (const point of points) {
        const half = Math.max(
          (Math.abs(point.dot(right) - across) + MARGIN_M) / (tall * aspect),
          (Math.abs(point.dot(up) - along) + MARGIN_M) / tall,
        );
        nearest = Math.max(nearest, point.dot(away) + half);
      }
      view.camera.aspect = aspect;
      view.camera.position.copy(right.multiplyScalar(across).addScaledVector(up, along).addScaledVector(away, nearest));
      view.camera.lookAt(view.camera.position.clone().sub(away));
      view.camera.updateProjectionMatrix();
      view.camera.updateMatrixWorld();
    }
  }

  /** Step back where a point would leave a view. @param {THREE.Vector3} point m */
  _keepInView(point) {
    const seen = this._seen.every(({ camera }) => {
      const { x, y } = point.clone().project(camera);
      return Math.max(Math.abs(x), Math.abs(y)) < EDGE;
    });
    if (seen) return;
    this._reached.push(point.clone());
    this._aim();
  }

  _frame() {
    // A frame on top of an unfinished one would hold up the page, and inputs with it.
    if (!this._finished()) {
      this._hold();
      return;
    }
    this._pending = false;
    this._heldMs = Math.max(this._heldMs - TAKEN_BACK_MS, 0);
    clearTimeout(this._soon);
    this._soon = undefined;
    const gliding = this._scene.advance(performance.now());
    this._keepInView(this._scene.tool);
    for (const call of this.beforeFrame) call();
    for (const { left, bottom, width, height, camera } of this._seen) {
      this._renderer.setViewport(left, bottom, width, height);
      this._renderer.setScissor(left, bottom, width, height);
      this._renderer.render(this._scene.scene, camera);
    }
    const gl = this._gl;
    this._fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    for (const call of this.afterFrame) call();
    if (gliding) this.invalidate();
  }

  _finished() {
    if (this._fence === null) return true;
    const gl = this._gl;
    if (gl.getSyncParameter(this._fence, gl.SYNC_STATUS) !== gl.SIGNALED && !gl.isContextLost()) return false;
    gl.deleteSync(this._fence);
    this._fence = null;
    return true;
  }

  /** Draw as soon as the frame before is done; coarser, where that takes too long too often. */
  _hold() {
    this._heldMs += LOOK_MS;
    if (this._heldMs > MOST_HELD_MS && this._ratio > COARSEST) {
      this._ratio = Math.max(this._ratio * 0.75, COARSEST);
      this._heldMs = 0;
      this.layOut();
    }
    setTimeout(() => this._frame(), LOOK_MS);
  }
}

/** The middle of what values there are. @param {number[]} values */
function middleOf(values) {
  return (Math.min(...values) + Math.max(...values)) / 2;
}
