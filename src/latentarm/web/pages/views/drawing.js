/** All that is drawn in three dimensions: the arm in two views, with goals, ghosts, trail and labels. */

import { THREE } from "../three/index.js";
import { sayPercent } from "../layout/words.js";
import { Ghosts } from "./ghosts.js";
import { Labels } from "./labels.js";
import { ArmScene } from "./scene.js";
import { ToolPaths } from "./tool_paths.js";
import { Views } from "./views.js";

/** @import {State} from "../connection/messages.js" */
/** @import {Direction} from "../inputs/deflection.js" */
/** @import {Values} from "../settings/settings.js" */
/** @import {Paths} from "./predictions.js" */

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
    this._toolPaths = new ToolPaths(scene.scene);
    this._still = matchMedia("(prefers-reduced-motion: reduce)");
    this._tick = -1;
    this._pose = this._around = "";
    /** @type {State["things"]} */
    this._things = null;
    this._first = true;
    // For scripts that measure how long an input takes to be seen.
    this._views.afterFrame.push(() => {
      document.dispatchEvent(new CustomEvent("arm-drawn", { detail: { tick: this._tick, tool: scene.tool.toArray() } }));
    });
  }

  /**
   * @param {{canvas: HTMLCanvasElement, front: HTMLElement, side: HTMLElement}} elements
   * @param {string} where address of the scene
   * @returns {Promise<Drawing>}
   * @throws where the browser cannot draw, or the scene cannot be loaded.
   */
  static async load(elements, where) {
    return new Drawing(elements, await ArmScene.load(where));
  }

  /**
   * @param {State} state
   * @param {Paths} paths
   * @param {Direction[]} pressed
   * @param {Values} wanted
   */
  show(state, paths, pressed, wanted) {
    // An arm at rest needs no new frame; a press or a new belief none that would be in the way of its motion.
    const pose = JSON.stringify([state.bodies, state.gripper?.width_m]);
    const around = JSON.stringify([state.belief, state.bound_m, paths, pressed, wanted]);
    const moved = pose !== this._pose || state.things !== this._things;
    if (!moved && around === this._around) return;
    this._pose = pose;
    this._things = state.things;
    this._around = around;
    this._tick = state.tick;
    this._scene.take(state, this._views.smooth && !this._still.matches);
    this._scene.markers.believe(state.belief);
    const likeliest = state.belief ? state.belief.indexOf(Math.max(...state.belief)) : -1;
    this._scene.markers.bound(wanted.showBound ? state.bound_m : null, likeliest);
    this._scene.showTrail(wanted.showTrail);
    this._scene.markTool(true);
    this._nameGoals(state.belief);
    this._ghosts.show(paths, pressed, wanted.showGhosts);
    this._lookFrom(wanted.seat);
    if (moved) this._views.invalidate();
    else this._views.invalidateSoon();
  }

  /**
   * A motion's pose instead of the arm's own; without names, tool, trail and belief, which would cover it.
   *
   * @param {number[][]} bodies
   * @param {Values["seat"]} seat
   */
  showPose(bodies, seat) {
    this._pose = "";
    this._scene.markTool(false);
    this._scene.showTrail(false);
    this._scene.take({ bodies, tool: this._scene.tool.toArray() }, false);
    this._scene.markers.believe(null);
    this._scene.markers.bound(null, -1);
    this._nameGoals(null, false);
    this._lookFrom(seat);
    this._views.invalidate();
  }

  /** A second arm that can be seen through, or none. @param {number[][] | null} bodies */
  shadow(bodies) {
    this._scene.shadow(bodies);
    this._views.invalidate();
  }

  /** The paths of the tools along a motion; none for an empty list. @param {[number, number, number][][]} paths */
  showToolPaths(paths) {
    this._toolPaths.show(paths);
    this._views.invalidate();
  }

  clearTrail() {
    this._scene.trail.clear();
    this._views.invalidate();
  }

  repaint() {
    this._scene.repaint();
    this._ghosts.repaint();
    this._toolPaths.repaint();
    this._views.invalidate();
  }

  /** @param {number[] | null} belief @param {boolean} [shown] */
  _nameGoals(belief, shown = true) {
    this._scene.goals.forEach((goal, index) => {
      const share = belief ? sayPercent(belief[index]) : undefined;
      this._labels.set(`goal-${index}`, new THREE.Vector3(...goal.position), goal.name, { share, shown });
    });
  }

  /** @param {Values["seat"]} seat */
  _lookFrom(seat) {
    if (!this._first && this._views.seat === seat) return;
    this._first = false;
    this._views.seat = seat;
    this._scene.advance(performance.now());
    this._views.layOut();
  }
}
