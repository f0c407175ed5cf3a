/** All that is drawn in three dimensions: the arm in two views, with goals, ghosts, ring, trail and labels. */

import * as THREE from "../three/three.module.min.js";
import { thingWords, zoneWords } from "../layout/thing_words.js";
import { say, sayNumber, sayPercent } from "../layout/words.js";
import { Ghosts } from "./ghosts.js";
import { Labels } from "./labels.js";
import { isLikeliest } from "./likeliest.js";
import { Ring } from "./ring.js";
import { ArmScene } from "./scene.js";
import { colourOf, shapeOf } from "./symbols.js";
import { ToolPaths } from "./tool_paths.js";
import { Views } from "./views.js";

/** @import {Predicted} from "./predictions.js" */
/** @typedef {{canvas: HTMLCanvasElement, front: HTMLElement, side: HTMLElement}} Elements */

/** Arrows and ring fade between these distances from what is wanted, m, to this share. */
const FADE_M = [0.05, 0.14];
const FADED = 0.2;

const ZONE_MARK = "◌";
/** In narrower views zones whose names would cover others have their mark alone, px. */
const NAMED_PX = 300;
/** How long a zone stays marked after it slowed the arm, ms: pushes at its limit would make it blink. */
const MARKED_MS = 500;

export class Drawing {
  /** @param {Elements} elements @param {ArmScene} scene */
  constructor(elements, scene) {
    this._scene = scene;
    this._views = new Views(elements.canvas, elements, scene);
    this._labels = new Labels(this._views);
    this._ghosts = new Ghosts(scene.scene, this._labels);
    this._ring = new Ring(scene.scene);
    this._toolPaths = new ToolPaths(scene.scene);
    this._still = matchMedia("(prefers-reduced-motion: reduce)");
    this._tick = -1;
    this._pose = this._around = this._pressed = "";
    /** @type {State["things"]} */
    this._things = null;
    /** @type {string | null} The zone that slows the arm, or did a moment ago. */
    this._zone = null;
    this._slowedAt = -Infinity;
    this._first = true;
    this._late = () => false;
    // Until it is known where the arm is.
    scene.scene.visible = false;
    // For tests and for Check the fit, which wait for it.
    this._views.afterFrame.push(() => {
      document.dispatchEvent(new CustomEvent("arm-drawn", { detail: { tick: this._tick, tool: scene.tool.toArray() } }));
    });
  }

  /** An error where the browser cannot draw, or the scene at this address cannot be loaded. @param {Elements} elements @param {string} where */
  static async load(elements, where) {
    const drawing = new Drawing(elements, await ArmScene.load(where));
    await drawing._views.prepare();
    return drawing;
  }

  /** Draw again, after the browser had lost the picture. */
  restore() {
    this._views.restore();
  }

  /**
   * True if the arm or a thing is somewhere else now. @param {State} state @param {Predicted} predicted @param {Direction[]} pressed
   * @param {Values} wanted @param {string | null} [thing] what the task is about now
   */
  show(state, predicted, pressed, wanted, thing = null) {
    // An arm at rest needs no new frame; a press or a new belief none that would be in the way of its motion.
    const pose = JSON.stringify([state.bodies, state.gripper?.width_m]);
    const zone = this._slowing(state.zone);
    const around = JSON.stringify([state.belief, predicted, pressed, wanted, thing, zone]);
    const moved = pose !== this._pose || state.things !== this._things;
    if (!moved && around === this._around) return false;
    const turned = this._pressed !== pressed.join();
    this._pressed = pressed.join();
    this._scene.scene.visible = true;
    this._pose = pose;
    this._things = state.things;
    this._around = around;
    this._tick = state.tick;
    this._scene.take(state, this._views.smooth && !this._still.matches && !this._late());
    this._scene.markers.believe(state.belief);
    const tool = new THREE.Vector3(...state.tool);
    this._scene.trail.object.visible = wanted.showTrail;
    this._scene.marker.object.visible = true;
    this._nameGoals(state.belief, tool, thing);
    this._nameThing(thing, tool);
    this._nameZones(zone);
    const clear = this._clearOf(tool, thing);
    this._ghosts.show(predicted.paths, pressed, wanted.showGhosts, clear);
    this._ring.show(predicted.ring, wanted.showGhosts, clear);
    this._lookFrom(wanted.seat);
    this._approach(tool, thing, predicted.paths);
    if (moved) this._views.invalidate();
    else this._views.invalidateSoon(turned);
    return moved;
  }

  /** A motion's pose instead of the arm's own; without what would cover it. @param {number[][]} bodies @param {Values["seat"]} seat */
  showPose(bodies, seat) {
    this._pose = "";
    this._scene.scene.visible = true;
    this._scene.marker.object.visible = this._scene.trail.object.visible = false;
    this._scene.take({ bodies, tool: this._scene.tool.toArray() }, false);
    this._scene.markers.believe(null);
    this._nameGoals(null, null, null);
    this._nameThing(null, null);
    this._lookFrom(seat);
    this._views.invalidate();
  }

  /** Things were placed anew: draw them where they stand now. */
  async renew() {
    this._nameGoals(null, null, null);
    await this._scene.renew();
    this._pose = "";
    this._scene.trail.clear();
    this._views.aim.forget();
    this._views.layOut();
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

  /** @param {() => boolean} late whether frames between two states would hold up what matters more @param {() => void} first what goes before each frame */
  pace(late, first) {
    this._late = late;
    this._views.beforeFrame.unshift(first);
    this._views.afterFrame.push(first);
  }

  clearTrail() {
    this._scene.trail.clear();
    this._views.invalidate();
  }

  repaint() {
    this._scene.repaint();
    this._ghosts.repaint();
    this._ring.repaint();
    this._toolPaths.repaint();
    this._views.invalidate();
  }

  /**
   * @param {number[] | null} belief
   * @param {THREE.Vector3 | null} tool null for no names
   * @param {string | null} thing of the task: its distance is shown, like that of the likeliest goal
   */
  _nameGoals(belief, tool, thing) {
    this._scene.goals.forEach(({ name }, index) => {
      const place = this._scene.markers.placeOf(index);
      const told = tool !== null && (name === thing || isLikeliest(belief, index));
      const shares = [...(belief ? [sayPercent(belief[index])] : []), ...(told ? [away(tool, place)] : [])];
      const look = { shown: tool !== null, share: shares.join(" · ") || undefined, thing: colourOf(index), mark: shapeOf(index).symbol, told };
      this._labels.set(`goal-${index}`, place, thingWords(name), look);
    });
  }

  /** The task's current thing, unless it is a goal, which has a name of its own. @param {string | null} name @param {THREE.Vector3 | null} tool */
  _nameThing(name, tool) {
    const place = name === null || this._scene.goals.some((goal) => goal.name === name) ? null : this._scene.things.placeOf(name);
    const share = place && tool ? away(tool, place) : undefined;
    this._labels.set("wanted", place, place && name ? thingWords(name) : "", { shown: place !== null, share });
  }

  /** The zone that slows the arm, or did a moment ago. @param {string | null} zone that slows it now */
  _slowing(zone) {
    const now = performance.now();
    if (zone !== null) this._slowedAt = now;
    if (zone !== null || now - this._slowedAt > MARKED_MS) this._zone = zone;
    return this._zone;
  }

  /** @param {string | null} slowing the zone that slows the arm */
  _nameZones(slowing) {
    this._scene.zones.slow(slowing);
    const room = this._views.views[0].width >= NAMED_PX;
    this._scene.zones.all.forEach(({ name, speed, top }, index) => {
      const text = name === slowing ? say("zone.slow", { zone: zoneWords(name) }) : zoneWords(name);
      const share = say("zone.speed", { centimetres: sayNumber(100 * speed) });
      this._labels.set(`zone-${index}`, top, text, { mark: ZONE_MARK, told: room || name === slowing, share });
    });
  }

  /** How much of arrows and ring is to be seen with the tool there. @param {THREE.Vector3} tool @param {string | null} thing */
  _clearOf(tool, thing) {
    const places = this._scene.goals.map((_, index) => this._scene.markers.placeOf(index));
    const wanted = this._placeOf(thing);
    const nearest = Math.min(...[...places, ...(wanted ? [wanted] : [])].map((place) => place.distanceTo(tool)));
    const [faded, clear] = FADE_M;
    return FADED + (1 - FADED) * Math.min(Math.max((nearest - faded) / (clear - faded), 0), 1);
  }

  /** Where a thing or a goal of the task is, m. @param {string | null} name */
  _placeOf(name) {
    const goal = this._scene.goals.findIndex((one) => one.name === name);
    return goal < 0 ? name === null ? null : this._scene.things.placeOf(name) : this._scene.markers.placeOf(goal);
  }

  /** Show from close by what the tool is near, with its arrows. @param {THREE.Vector3} tool @param {string | null} thing @param {Predicted["paths"]} paths */
  _approach(tool, thing, paths) {
    const place = this._placeOf(thing);
    const tips = Object.values(paths).flatMap((path) => (path ? [new THREE.Vector3(...path[path.length - 1])] : []));
    this._views.approach(place ? [tool, place, ...tips] : []);
  }

  /** @param {Values["seat"]} seat */
  _lookFrom(seat) {
    if (!this._first && this._views.aim.seat === seat) return;
    this._first = false;
    this._views.aim.seat = seat;
    this._scene.advance(performance.now());
    this._views.layOut();
  }
}

/** How far it is from one to the other, in words. @param {THREE.Vector3} from @param {THREE.Vector3} to */
function away(from, to) {
  return say("place.away", { centimetres: Math.round(100 * from.distanceTo(to)) });
}
