/** The arm, what stands about it, its goals, the tool and the trail as one three.js scene; poses glide from one state to the next. */

import * as THREE from "../three/three.module.min.js";
import { colour } from "./colours.js";
import { GoalMarkers } from "./goal_markers.js";
import { glide, groupOf, meshGeometry, place, stanceOf } from "./shapes.js";
import { Shadows } from "./shadows.js";
import { Table } from "./table.js";
import { Things } from "./things.js";
import { ToolMarker } from "./tool_marker.js";
import { Trail } from "./trail.js";
import { Zones } from "./zones.js";

/** @import {SceneDescription} from "./scene_description.js" */
/** @import {Meshes} from "./shapes.js" */

/** States come about this far apart, ms; poses glide for no longer. */
const LONGEST_GLIDE_MS = 60;
const FRAME_MS = 16;
/** How wide the shadow of a link is, from its middle, and how far apart those of two are, m. */
const LINK_M = 0.1;
const APART_M = 0.1;

export class ArmScene {
  /** @param {SceneDescription} description @param {Meshes} meshes @param {string} where their address */
  constructor(description, meshes, where) {
    this.scene = new THREE.Scene();
    this._meshes = meshes;
    this._where = where;
    /** Where the tool is shown, m. */
    this.tool = new THREE.Vector3();
    this.trail = new Trail();
    this._table = new Table(description.obstacles);
    this.zones = new Zones(description.zones ?? []);
    this.marker = new ToolMarker();
    this._bodies = description.bodies.map(({ geoms }) => groupOf(geoms, meshes));
    this._fingers = description.fingers.map(({ body, opens, at, geoms }) => {
      const finger = { group: groupOf(geoms, meshes), opens: new THREE.Vector3(...opens) };
      finger.group.position.copy(finger.opens).multiplyScalar(at);
      this._bodies[body].add(finger.group);
      return finger;
    });
    this.goals = description.goals;
    this.things = this._thingsOf(description);
    this.markers = this._markersOf(description);
    this._shades = new Shadows(2 * this._bodies.length + description.things.length);
    this._shadowMaterial = new THREE.MeshLambertMaterial({
      // Behind what it coincides with.
      transparent: true, opacity: 0.4, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2,
    });
    /** @type {THREE.Group[] | null} */
    this._shadows = null;
    /** @type {ReturnType<typeof stanceOf>[]} */
    this._from = [];
    /** @type {number[][] | null} */
    this._to = null;
    this._toolFrom = new THREE.Vector3();
    this._toolTo = new THREE.Vector3();
    this._began = this._glideMs = 0;
    this._heardAt = 0;

    const sun = new THREE.DirectionalLight(0xffffff, 1.7);
    sun.position.set(0.6, -0.8, 1.6);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a98a0, 2.1), sun);
    this.scene.add(...this._bodies, ...this.things.objects, ...this._table.objects, this._shades.object, ...this.zones.objects, this.marker.object, ...this.markers.objects, this.trail.object);
    this.repaint();
  }

  /** Fetch the description and its meshes. @param {string} where their address @returns {Promise<ArmScene>} */
  static async load(where) {
    const description = await describe(where);
    const numbers = new Set(description.bodies.flatMap((body) => body.geoms).map((geom) => geom.mesh));
    numbers.delete(null);
    /** @type {Meshes} */
    const meshes = new Map();
    await Promise.all([.../** @type {Set<number>} */ (numbers)].map(async (number) => {
      meshes.set(number, meshGeometry(await (await fetch(`${where}/mesh/${number}`)).arrayBuffer()));
    }));
    return new ArmScene(description, meshes, where);
  }

  /** Things have been placed anew, and goals are elsewhere: fetch where. */
  async renew() {
    const description = await describe(this._where);
    this.scene.remove(...this.things.objects, ...this.markers.objects);
    this.goals = description.goals;
    this.things = this._thingsOf(description);
    this.markers = this._markersOf(description);
    this.scene.add(...this.things.objects, ...this.markers.objects);
  }

  /** @param {SceneDescription} description */
  _thingsOf({ things, grains }) {
    return new Things(things, grains, this._meshes, new Set(this.goals.map(({ name }) => name)));
  }

  /** @param {SceneDescription} description */
  _markersOf({ goals }) {
    return new GoalMarkers(goals, ({ name }) => this.things.placeOf(name), this._table.height);
  }

  /** From what is shown now to a new state; fingers at once. @param {Pick<State, "bodies" | "tool"> & Partial<State>} state @param {boolean} gliding */
  take(state, gliding) {
    const now = performance.now();
    const first = this._to === null;
    this._from = this._bodies.map(stanceOf);
    this._toolTo = new THREE.Vector3(...state.tool);
    this._toolFrom = (first ? this._toolTo : this.tool).clone();
    this._glideMs = gliding && !first ? Math.min(now - this._heardAt, LONGEST_GLIDE_MS) : 0;
    this._heardAt = now;
    // The next frame is seen a little later than it is begun: it already shows some of the motion.
    this._began = now - FRAME_MS;
    this._to = state.bodies;
    // Both fingers, with this opening between them.
    if (state.gripper) for (const { group, opens } of this._fingers) group.position.copy(opens).multiplyScalar(state.gripper.width_m / 2);
    this.things.take(state.things ?? null);
    this.trail.extend(this._toolTo);
  }

  /** Show the moment. @param {number} now ms @returns {boolean} whether poses are still gliding. */
  advance(now) {
    const to = this._to;
    if (to === null) return false;
    const share = this._glideMs > 0 ? Math.min(Math.max((now - this._began) / this._glideMs, 0), 1) : 1;
    this._bodies.forEach((body, index) => {
      if (to[index]) glide(body, this._from[index], to[index], share);
    });
    this.things.advance(share);
    this.markers.follow();
    this._shade();
    this.tool.lerpVectors(this._toolFrom, this._toolTo, share);
    this.marker.moveTo(this.tool, this.things.heightUnder(this.tool, this._table.height));
    return share < 1;
  }

  /** Shadows under the links, from joint to joint, and under the things. */
  _shade() {
    /** @type {{at: THREE.Vector3, radius: number}[]} */
    const links = [];
    this._bodies.forEach(({ position }, index) => {
      for (const share of [0.5, 0]) {
        const at = position.clone().lerp(this._bodies[Math.max(index - 1, 0)].position, share);
        // What stands over another link makes no second shadow.
        if (links.every(({ at: { x, y } }) => Math.hypot(x - at.x, y - at.y) > APART_M)) links.push({ at, radius: LINK_M });
      }
    });
    this._shades.show([...links, ...this.things.footprints].map(({ at, radius }) => (
      { at, radius, floor: this.things.heightUnder(at, this._table.height) }
    )));
  }

  /** A second arm that can be seen through, or none. @param {number[][] | null} bodies */
  shadow(bodies) {
    this._shadows ??= this._bodies.map((body) => {
      const copy = body.clone();
      copy.traverse((part) => {
        if (part instanceof THREE.Mesh) part.material = this._shadowMaterial;
      });
      this.scene.add(copy);
      return copy;
    });
    this._shadows.forEach((shadow, index) => {
      shadow.visible = bodies !== null;
      if (bodies) place(shadow, bodies[index]);
    });
  }

  /** Take the colours of the page as they are now. */
  repaint() {
    this.scene.background = new THREE.Color(colour("view"));
    this._shadowMaterial.color.set(colour("way"));
    for (const part of [this._table, this.zones, this.marker, this.trail, this.markers]) part.repaint();
  }

  /** Where the joints are, m. */
  get joints() {
    return this._bodies.map(({ position }) => position);
  }

  /** Points that a view must hold. */
  extent() {
    const goals = this.goals.map((goal) => new THREE.Vector3(...goal.position));
    const zones = this.zones.all.map(({ top }) => top.clone());
    return [...this.joints.map((joint) => joint.clone()), ...this.things.extent, ...goals, ...zones, this.tool.clone()];
  }
}

/** The server's current scene. @param {string} where its address @returns {Promise<SceneDescription>} */
async function describe(where) {
  return (await fetch(`${where}/scene.json`, { cache: "no-store" })).json();
}
