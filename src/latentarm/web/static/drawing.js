/** All that is drawn in three dimensions: the arm in two views, with goals, ghosts, trail and labels. */

import { THREE } from "nicegui-scene";
import { Ghosts } from "./ghosts.js";
import { Labels } from "./labels.js";
import { ArmScene } from "./scene.js";
import { Views } from "./views.js";

/** @typedef {import("./dpad.js").Direction} Direction */

export class Drawing {
  /**
   * @param {{canvas: HTMLCanvasElement, front: HTMLElement, side: HTMLElement}} elements
   * @param {ArmScene} scene
   */
  constructor(elements, scene) {
    this._scene = scene;
    this._views = new Views(elements.canvas, elements, scene);
    this._labels = new Labels(this._views);
    this._ghosts = new Ghosts(scene.scene, this._labels);
    this._still = matchMedia("(prefers-reduced-motion: reduce)");
    this._tick = -1;
    this._shown = "";
    this._first = true;
    // For scripts that measure how long an input takes to be seen.
    this._views.afterFrame.push(() => {
      document.dispatchEvent(new CustomEvent("arm-drawn", { detail: { tick: this._tick, tool: scene.tool.toArray() } }));
    });
  }

  /**
   * @param {{canvas: HTMLCanvasElement, front: HTMLElement, side: HTMLElement}} elements
   * @returns {Promise<Drawing>}
   * @throws where the browser cannot draw, or the scene cannot be had.
   */
  static async load(elements) {
    return new Drawing(elements, await ArmScene.load());
  }

  /**
   * @param {any} state
   * @param {Record<Direction, number[][] | null>} paths
   * @param {Direction[]} pressed
   * @param {import("./settings.js").Values} wanted
   */
  show(state, paths, pressed, wanted) {
    // An arm at rest needs no new frame.
    const shown = JSON.stringify([state.bodies, state.belief, state.bound_m, paths, pressed, wanted]);
    if (shown === this._shown) return;
    this._shown = shown;
    this._tick = state.tick;
    this._scene.take(state, this._views.smooth && !this._still.matches);
    this._scene.believe(state.belief);
    const likeliest = state.belief ? state.belief.indexOf(Math.max(...state.belief)) : -1;
    this._scene.bound(wanted.showBound ? state.bound_m : null, likeliest);
    this._scene.showTrail(wanted.showTrail);
    this._scene.goals.forEach((/** @type {any} */ goal, /** @type {number} */ index) => {
      const share = state.belief ? `${Math.round(100 * state.belief[index])} %` : undefined;
      this._labels.set(`goal-${index}`, new THREE.Vector3(...goal.position), goal.name, { share });
    });
    this._ghosts.show(paths, pressed, wanted.showGhosts);
    if (this._first || this._views.seat !== wanted.seat) {
      this._first = false;
      this._views.seat = /** @type {"facing" | "behind"} */ (wanted.seat);
      this._scene.advance(performance.now());
      this._views.layOut();
    }
    this._views.invalidate();
  }

  clearTrail() {
    this._scene.clearTrail();
    this._views.invalidate();
  }

  repaint() {
    this._scene.repaint();
    this._ghosts.repaint();
    this._views.invalidate();
  }
}
