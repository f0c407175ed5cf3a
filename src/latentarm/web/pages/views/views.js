/** Two views of one scene, drawn on one canvas, only when something has changed. */

import * as THREE from "../three/three.module.min.js";
import { Aim, FOV_DEG } from "./aim.js";
import { SOFTWARE } from "./fineness.js";
import { PixelShare } from "./pixel_share.js";

/** How often a frame's end is checked, ms. */
const LOOK_MS = 4;
const LONGEST_COMPILING_MS = 3000;
/** Without a graphics processor, pixels are dear from the start. */
const SOFTWARE_SHARE = 0.7;
/** Work for the next frame waits no longer than this, ms. */
const SOON_MS = 120;
/** Without a graphics processor, the small view is drawn so much less often, ms, and never in the first frame of a motion. */
const SMALL_MS = 150;

/** @import {Box} from "./label_layout.js" */

/** @typedef {Views["views"][number]} View */

export class Views {
  /** @param {HTMLCanvasElement} canvas lies under both views @param {{front: HTMLElement, side: HTMLElement}} elements @param {ArmScene} scene */
  constructor(canvas, elements, scene) {
    this._canvas = canvas;
    this._scene = scene;
    this.aim = new Aim(scene);
    /** Whether there is time for frames between two states. */
    this.smooth = !SOFTWARE;
    // Where the small view is not drawn each time, the frame before is kept.
    this._renderer = new THREE.WebGLRenderer({
      canvas, antialias: !SOFTWARE, alpha: true, powerPreference: "low-power", preserveDrawingBuffer: SOFTWARE,
    });
    this._renderer.setScissorTest(true);
    this._pixels = new PixelShare();
    /** @type {WebGL2RenderingContext} */
    this._gl = /** @type {WebGL2RenderingContext} */ (this._renderer.getContext());
    /** @type {WebGLSync | null} Passed by the graphics processor when the last frame is done. */
    this._fence = null;
    this._pending = false;
    /** When there was a frame last, ms. */
    this._drawnAt = -Infinity;
    /** When the small view was drawn last, ms; -Infinity where it must be in the next frame. */
    this._smallAt = -Infinity;
    /** Whether the page shows it. */
    this._shown = true;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this._soon = undefined;
    this.views = /** @type {("front" | "side")[]} */ (["front", "side"]).map((name) => ({
      name,
      element: elements[name],
      labels: /** @type {HTMLElement} */ (elements[name].querySelector(".labels")),
      camera: new THREE.PerspectiveCamera(FOV_DEG, 1, 0.05, 20),
      // Its left lower corner on the canvas, and its size, px.
      left: 0, bottom: 0, width: 0, height: 0,
    }));
    for (const view of this.views) view.camera.up.set(0, 0, 1);
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

  /** Come close, where the first two of these are near each other. @param {THREE.Vector3[]} points m; none for never */
  approach(points) {
    if (!this.aim.approach(points)) return;
    /** @type {HTMLElement} */ (this._canvas.parentElement).toggleAttribute("data-close", this.aim.close);
    this.layOut();
  }

  /** Fit the canvas and the cameras to the page. */
  layOut() {
    const box = this._canvas.getBoundingClientRect();
    this._shown = Boolean(box.width && box.height);
    if (!this._shown) return;
    this._renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * (SOFTWARE ? SOFTWARE_SHARE : 1) * this._pixels.share);
    this._renderer.setSize(box.width, box.height, false);
    for (const view of this.views) {
      const { element } = view;
      const place = element.getBoundingClientRect();
      view.left = place.left - box.left + element.clientLeft;
      view.bottom = box.bottom - place.bottom + element.clientTop;
      view.width = element.clientWidth;
      view.height = element.clientHeight;
    }
    this._smallAt = -Infinity;
    this.aim.turn(this.seen);
    this.invalidate();
  }

  /** Draw again, after the graphics processor had lost everything. */
  restore() {
    this._fence = null;
    this._renderer.setScissorTest(true);
    this.layOut();
  }

  /** Where a point is, CSS px from its left upper corner, and how many of them a metre has there. @param {View} view @param {THREE.Vector3} point m */
  project({ camera, width, height }, point) {
    const seen = point.clone().project(camera);
    const away = -point.clone().applyMatrix4(camera.matrixWorldInverse).z;
    const perMetre = (height * camera.projectionMatrix.elements[5]) / (2 * away);
    return { x: ((seen.x + 1) / 2) * width, y: ((1 - seen.y) / 2) * height, perMetre };
  }

  /** The views for which the page has room, the largest first. */
  get seen() {
    return this.views.filter(({ width, height }) => width > 0 && height > 0).sort((one, other) => other.width * other.height - one.width * one.height);
  }

  /** What the small view covers of the large one, px from the left upper corner of that. @returns {Box[]} */
  get covered() {
    const [large, ...others] = this.seen;
    return others.map(({ left, bottom, width, height }) => {
      const [from, top] = [left - large.left, large.bottom + large.height - bottom - height];
      return { left: from, top, right: from + width, bottom: top + height };
    }).filter(({ left, top, right, bottom }) => left < large.width && right > 0 && top < large.height && bottom > 0);
  }

  /** Where the joints are shown, m. */
  get joints() {
    return this._scene.joints;
  }

  /** Where the tool is shown, m. */
  get tool() {
    return this._scene.tool;
  }

  _frame() {
    // A frame on top of an unfinished one would hold up the page, and inputs with it.
    if (!this._finished()) {
      if (this._pixels.held(LOOK_MS)) this.layOut();
      setTimeout(() => this._frame(), LOOK_MS);
      return;
    }
    this._pending = false;
    clearTimeout(this._soon);
    this._soon = undefined;
    if (this._pixels.inTime()) this.layOut();
    const now = performance.now();
    const gliding = this._scene.advance(now);
    this.aim.follow(this.seen);
    for (const call of this.beforeFrame) call();
    for (const { left, bottom, width, height, camera } of this._drawsSmall(now) ? this.seen : this.seen.slice(0, 1)) {
      this._renderer.setViewport(left, bottom, width, height);
      this._renderer.setScissor(left, bottom, width, height);
      this._renderer.render(this._scene.scene, camera);
    }
    this._drawnAt = now;
    const gl = this._gl;
    this._fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    for (const call of this.afterFrame) call();
    if (gliding) this.invalidate();
  }

  /** Whether this frame has the small view too; it follows soon where not. @param {number} now ms */
  _drawsSmall(now) {
    const due = now - this._smallAt > SMALL_MS && now - this._drawnAt < SMALL_MS;
    if (this.smooth || due || this._smallAt === -Infinity || this.covered.length) {
      this._smallAt = now;
      return true;
    }
    this._soon = setTimeout(() => this.invalidate(), SMALL_MS / 2);
    return false;
  }

  _finished() {
    if (this._fence === null) return true;
    const gl = this._gl;
    if (gl.getSyncParameter(this._fence, gl.SYNC_STATUS) !== gl.SIGNALED && !gl.isContextLost()) return false;
    gl.deleteSync(this._fence);
    this._fence = null;
    return true;
  }
}
