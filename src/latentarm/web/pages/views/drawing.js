/** All that is drawn in three dimensions: the arm in two views, with goals, ghosts, trail and labels. */

import { THREE } from "../three/index.js";
import { Ghosts } from "./ghosts.js";
import { Labels } from "./labels.js";
import { ArmScene } from "./scene.js";
import { Views } from "./views.js";
import { Ways } from "./tool_paths.js";

/** @typedef {import("../inputs/dpad.js").Direction} Direction */

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
    this._ways = new Ways(scene.scene);
    this._still = matchMedia("(prefers-reduced-motion: reduce)");
    this._tick = -1;
    this._pose = this._around = "";
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
   * @param {import("../settings/settings.js").Values} wanted
   */
  show(state, paths, pressed, wanted) {
    // An arm at rest needs no new frame; a press or a new belief none that would be in the way of its motion.
    const pose = JSON.stringify(state.bodies);
    const around = JSON.stringify([state.belief, state.bound_m, paths, pressed, wanted]);
    const moved = pose !== this._pose;
    if (!moved && around === this._around) return;
    this._pose = pose;
    this._around = around;
    this._tick = state.tick;
    this._scene.take(state, this._views.smooth && !this._still.matches);
    this._scene.believe(state.belief);
    const likeliest = state.belief ? state.belief.indexOf(Math.max(...state.belief)) : -1;
    this._scene.bound(wanted.showBound ? state.bound_m : null, likeliest);
    this._scene.showTrail(wanted.showTrail);
    this._scene.markTool(true);
    this._nameGoals(state.belief);
    this._ghosts.show(paths, pressed, wanted.showGhosts);
    this._lookFrom(/** @type {"facing" | "behind"} */ (wanted.seat));
    if (moved) this._views.invalidate();
    else this._views.invalidateSoon();
  }

  /**
   * A motion's pose instead of the arm's own; without names, tool, trail and belief, which would cover it.
   *
   * @param {number[][]} bodies
   * @param {"facing" | "behind"} seat
   */
  showPose(bodies, seat) {
    this._pose = "";
    this._scene.markTool(false);
    this._scene.showTrail(false);
    this._scene.take({ bodies, tool: this._scene.tool.toArray() }, false);
    this._scene.believe(null);
    this._scene.bound(null, -1);
    this._nameGoals(null, false);
    this._lookFrom(seat);
    this._views.invalidate();
  }

  /** A second arm that can be seen through, or none. @param {number[][] | null} bodies */
  shadow(bodies) {
    this._scene.shadow(bodies);
    this._views.invalidate();
  }

  /** The ways of the tools along a motion; none for an empty list. @param {number[][][]} ways */
  showWays(ways) {
    this._ways.show(ways);
    this._views.invalidate();
  }

  clearTrail() {
    this._scene.clearTrail();
    this._views.invalidate();
  }

  repaint() {
    this._scene.repaint();
    this._ghosts.repaint();
    this._ways.repaint();
    this._views.invalidate();
  }

  /** @param {number[] | null} belief @param {boolean} [shown] */
  _nameGoals(belief, shown = true) {
    this._scene.goals.forEach((/** @type {any} */ goal, /** @type {number} */ index) => {
      const share = belief ? `${Math.round(100 * belief[index])} %` : undefined;
      this._labels.set(`goal-${index}`, new THREE.Vector3(...goal.position), goal.name, { share, shown });
    });
  }

  /** @param {"facing" | "behind"} seat */
  _lookFrom(seat) {
    if (!this._first && this._views.seat === seat) return;
    this._first = false;
    this._views.seat = seat;
    this._scene.advance(performance.now());
    this._views.layOut();
  }
}
