/** Two cameras on one scene: front and side, drawn on one canvas, only when something has changed. */

import { THREE } from "../three/index.js";

const FOV_DEG = 32;
/** Room around the outermost points: the arm is thick, and labels are next to goals. */
const MARGIN_M = 0.13;
/** So many more frames that had to wait than frames that were drawn, and the drawing gets coarser. */
const MOST_HELD = 40;
const COARSEST = 0.5;
/** So far out, as a share of half a view, the tool is about to leave it. */
const EDGE = 0.92;
/** Without a graphics processor, pixels are dear from the start. */
const SOFTWARE_SHARE = 0.7;

/** What can wait for the next frame waits no longer than this, ms. */
const SOON_MS = 120;

/** @import {ArmScene} from "./scene.js" */

/** Where each camera looks from, as directions from the middle of the scene. @type {Record<string, Record<"front" | "side", [number, number, number]>>} */
const DIRECTIONS = {
  facing: { front: [1, 0, 0.42], side: [0.08, -1, 0.22] },
  behind: { front: [-1, -0.55, 0.75], side: [0.08, -1, 0.22] },
  flat: { front: [0, -0.01, 1], side: [0, -1, 0.8] },
};

/** @typedef {{element: HTMLElement, labels: HTMLElement, camera: THREE.PerspectiveCamera, name: "front" | "side"}} View */

export class Views {
  /**
   * @param {HTMLCanvasElement} canvas lies under both views
   * @param {{front: HTMLElement, side: HTMLElement}} elements
   * @param {ArmScene} scene
   */
  constructor(canvas, elements, scene) {
    this._canvas = canvas;
    this._scene = scene;
    const software = drawsInSoftware();
    /** Whether there is time for frames between two states. */
    this.smooth = !software;
    this._renderer = new THREE.WebGLRenderer({ canvas, antialias: !software, alpha: true, powerPreference: "low-power" });
    this._renderer.setScissorTest(true);
    this._ratio = Math.min(devicePixelRatio, 2) * (software ? SOFTWARE_SHARE : 1);
    /** @type {WebGL2RenderingContext} */
    this._gl = /** @type {WebGL2RenderingContext} */ (this._renderer.getContext());
    /** @type {WebGLSync | null} Passed by the graphics processor when the last frame is done. */
    this._fence = null;
    this._held = 0;
    this._pending = 0;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this._soon = undefined;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this._wait = undefined;
    /** @type {"facing" | "behind"} */
    this.seat = "facing";
    /** @type {View[]} */
    this.views = /** @type {("front" | "side")[]} */ (["front", "side"]).map((name) => ({
      name,
      element: elements[name],
      labels: /** @type {HTMLElement} */ (elements[name].querySelector(".labels")),
      camera: new THREE.PerspectiveCamera(FOV_DEG, 1, 0.05, 20),
    }));
    for (const view of this.views) view.camera.up.set(0, 0, 1);
    /** @type {THREE.Vector3[]} Where the tool was when it would have left a view, m: cameras hold these too. */
    this._reached = [];
    /** The least time between two frames, ms. */
    this.frameGapMs = () => 0;
    this._drawnAt = -Infinity;
    /** @type {(() => void)[]} Called before each frame, to move labels. */
    this.beforeFrame = [];
    /** @type {(() => void)[]} Called after each frame. */
    this.afterFrame = [];
    new ResizeObserver(() => this.layOut()).observe(canvas);
    document.addEventListener("visibilitychange", () => this.invalidate());
  }

  /** Something has changed: draw with the next frame. */
  invalidate() {
    if (this._pending || document.hidden) return;
    this._pending = requestAnimationFrame((now) => this._frame(now));
  }

  /** Something has changed that may be drawn with whatever changes next, where each frame takes long. */
  invalidateSoon() {
    if (this.smooth) this.invalidate();
    else this._soon ??= setTimeout(() => this.invalidate(), SOON_MS);
  }

  /** The tool is somewhere else altogether: forget where it has been. */
  forget() {
    this._reached = [];
    this.layOut();
  }

  /** Fit the canvas and the cameras to the page. */
  layOut() {
    const box = this._canvas.getBoundingClientRect();
    if (!box.width || !box.height) return;
    this._renderer.setPixelRatio(this._ratio);
    this._renderer.setSize(box.width, box.height, false);
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
    return {
      x: ((seen.x + 1) / 2) * view.element.clientWidth,
      y: ((1 - seen.y) / 2) * view.element.clientHeight,
    };
  }

  /** Turn both cameras to the scene, as near as holds all of it. */
  _aim() {
    const points = [...this._scene.extent(), ...this._reached];
    const size = new THREE.Box3().setFromPoints(points).getSize(new THREE.Vector3());
    const flat = size.z < 0.1 * Math.max(size.x, size.y);
    const directions = DIRECTIONS[flat ? "flat" : this.seat];
    for (const view of this.views) {
      const aspect = view.element.clientWidth / Math.max(view.element.clientHeight, 1);
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
    const seen = this.views.every(({ camera }) => {
      const { x, y } = point.clone().project(camera);
      return Math.max(Math.abs(x), Math.abs(y)) < EDGE;
    });
    if (seen) return;
    this._reached.push(point.clone());
    this._aim();
  }

  /** @param {number} now */
  _frame(now) {
    this._pending = 0;
    const early = this._drawnAt + this.frameGapMs() - now;
    if (early > 0) {
      this._wait ??= setTimeout(() => {
        this._wait = undefined;
        this.invalidate();
      }, early);
      return;
    }
    this._drawnAt = now;
    // A frame on top of an unfinished one would hold up the page, and inputs with it.
    if (!this._finished()) {
      this._hold();
      return;
    }
    this._held = Math.max(this._held - 1, 0);
    clearTimeout(this._soon);
    this._soon = undefined;
    const gliding = this._scene.advance(now);
    this._keepInView(this._scene.tool);
    for (const call of this.beforeFrame) call();
    const canvas = this._canvas.getBoundingClientRect();
    for (const { element, camera } of this.views) {
      const box = element.getBoundingClientRect();
      const left = box.left - canvas.left + element.clientLeft;
      const bottom = canvas.bottom - box.bottom + element.clientTop;
      this._renderer.setViewport(left, bottom, element.clientWidth, element.clientHeight);
      this._renderer.setScissor(left, bottom, element.clientWidth, element.clientHeight);
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

  /** Draw with the next frame instead; coarser, where that happens too often. */
  _hold() {
    this._held += 1;
    if (this._held > MOST_HELD && this._ratio > COARSEST) {
      this._ratio = Math.max(this._ratio * 0.75, COARSEST);
      this._held = 0;
      this.layOut();
    }
    this.invalidate();
  }
}

/** The middle of what values there are. @param {number[]} values */
function middleOf(values) {
  return (Math.min(...values) + Math.max(...values)) / 2;
}

/** Whether there is no graphics processor: then every pixel is the processor's work. */
function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const about = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = about ? String(gl?.getParameter(about.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}
