/** The things about the arm, which glide from one state to the next, and grains. */

import * as THREE from "../three/three.module.min.js";
import { ROUND } from "./fineness.js";
import { glide, groupOf, materialOf, place, stanceOf, standing } from "./shapes.js";

/** @import {Grains, Thing} from "./scene_description.js" */
/** @import {Meshes} from "./shapes.js" */

export class Things {
  /** @param {Thing[]} things @param {Grains[]} grains @param {Meshes} meshes @param {Set<string>} food names of what may be meant */
  constructor(things, grains, meshes, food) {
    this._things = things.map(({ name, pose, geoms }) => {
      const group = Object.assign(groupOf(geoms, meshes, food.has(name)), { name });
      place(group, pose);
      return group;
    });
    this._grains = grains.map(({ radius, rgba, positions }) => {
      const balls = new THREE.InstancedMesh(new THREE.IcosahedronGeometry(radius, ROUND.divided), materialOf(rgba), positions.length / 3);
      // They may go anywhere from where they are at first.
      balls.frustumCulled = false;
      scatter(balls, positions);
      return balls;
    });
    const boxes = this._things.map((thing) => new THREE.Box3().setFromObject(thing));
    /** Corners of what there is at first: a thing that falls off the table does not take the view along. */
    this.extent = boxes.flatMap(({ min, max }) => [min, max]);
    this._radii = boxes.map(({ min, max }) => 0.6 * Math.max(max.x - min.x, max.y - min.y));
    /** Fixed things. */
    this._standing = boxes.filter((_, index) => things[index].fixed);
    // Soft parts are added only now: the tool goes into it, and nothing stands on it.
    this._things.forEach((group, index) => {
      const { fixed, soft = [] } = things[index];
      if (fixed) group.clear();
      else group.add(groupOf(soft, meshes, food.has(things[index].name)));
    });
    const still = things.filter(({ fixed }) => fixed).map(({ pose, geoms, soft = [] }) => ({ pose, geoms: [...geoms, ...soft] }));
    this.objects = [...this._things, ...this._grains, standing(still, meshes)];
    /** @type {ReturnType<typeof stanceOf>[]} */
    this._from = [];
    /** @type {State["things"]} */
    this._to = null;
  }

  /** Where a thing is shown now, m; null if nothing has that name. @param {string} name */
  placeOf(name) {
    return this._things.find((thing) => thing.name === name)?.position ?? null;
  }

  /** Where things are, and how wide from their middle, m. */
  get footprints() {
    return this._things.map(({ position }, index) => ({ at: position, radius: this._radii[index] }));
  }

  /** How high what stands under a point is, m; the table where nothing does. @param {THREE.Vector3} point @param {number} table m */
  heightUnder({ x, y, z }, table) {
    const under = this._standing.filter(({ min, max }) => min.x < x && x < max.x && min.y < y && y < max.y && max.z < z);
    return Math.max(table, ...under.map(({ max }) => max.z));
  }

  /** Where things go from what is shown now; null for no news. @param {State["things"]} things */
  take(things) {
    if (things === null) return;
    for (const { name, seen } of things.seen ?? []) {
      const group = this._things.find((thing) => thing.name === name);
      if (!group) continue;
      group.visible = seen !== "unseen";
      // A lost thing is drawn as a cage.
      group.traverse((part) => {
        if (part instanceof THREE.Mesh) part.material.wireframe = seen === "lost";
      });
    }
    this._from = this._things.map(stanceOf);
    if (things !== this._to) this._grains.forEach((balls, index) => scatter(balls, things.grains[index]));
    this._to = things;
  }

  /** Show them so far on their way. @param {number} share in [0, 1] */
  advance(share) {
    this._to?.poses.forEach((pose, index) => glide(this._things[index], this._from[index], pose, share));
  }
}

/** @param {THREE.InstancedMesh} balls @param {number[]} positions x, y, z of one after the other, m */
function scatter(balls, positions) {
  const at = new THREE.Matrix4();
  for (let grain = 0; grain < balls.count; grain += 1) {
    balls.setMatrixAt(grain, at.makeTranslation(positions[3 * grain], positions[3 * grain + 1], positions[3 * grain + 2]));
  }
  balls.instanceMatrix.needsUpdate = true;
}
