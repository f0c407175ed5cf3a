/** The arm, its goals, the tool and the trail as one three.js scene; poses glide from one state to the next. */

import { THREE } from "../three/index.js";
import { colour } from "./colours.js";
import { meshGeometry, obstacleOf, place, shapeOf } from "./shapes.js";

const FLOOR_M = 1.6;
const TRAIL_POINTS = 600;
const TRAIL_STEP_M = 0.008;
/** States come about this far apart, ms; poses glide for no longer. */
const LONGEST_GLIDE_MS = 60;
const FRAME_MS = 16;

export class ArmScene {
  /** @param {any} description what /scene.json holds @param {Map<number, any>} meshes */
  constructor(description, meshes) {
    this.scene = new THREE.Scene();
    this.goals = description.goals;
    this.tool = new THREE.Vector3();
    this._sky = new THREE.HemisphereLight(0xffffff, 0x8a98a0, 2.1);
    const sun = new THREE.DirectionalLight(0xffffff, 1.7);
    sun.position.set(0.6, -0.8, 1.6);
    this.scene.add(this._sky, sun);

    this._bodies = description.bodies.map((/** @type {any} */ body) => {
      const group = new THREE.Group();
      for (const geom of body.geoms) {
        const shape = shapeOf(geom, meshes);
        if (shape) group.add(shape);
      }
      return group;
    });
    this.scene.add(...this._bodies);
    this._shade = new THREE.MeshLambertMaterial({
      // Behind what it coincides with.
      transparent: true, opacity: 0.4, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2,
    });
    /** @type {any[] | null} */
    this._shadows = null;
    this._from = this._bodies.map(() => null);
    /** @type {number[][] | null} */
    this._to = null;
    this._began = this._glideMs = 0;
    this._heardAt = 0;

    this._addObstacles(description.obstacles);
    this._addTool();
    this._addGoals();
    this._addTrail();
    this.repaint();
  }

  /** Fetch the description and its meshes. @returns {Promise<ArmScene>} */
  static async load() {
    const description = await (await fetch("/scene.json")).json();
    const geoms = description.bodies.flatMap((/** @type {any} */ body) => body.geoms);
    const numbers = new Set(geoms.map((/** @type {any} */ geom) => geom.mesh));
    numbers.delete(null);
    const meshes = new Map();
    await Promise.all([...numbers].map(async (number) => {
      meshes.set(number, meshGeometry(await (await fetch(`/mesh/${number}`)).arrayBuffer()));
    }));
    return new ArmScene(description, meshes);
  }

  /** A new state: where the bodies and the tool go from what is shown now. @param {any} state @param {boolean} gliding */
  take(state, gliding) {
    const now = performance.now();
    this._from = this._bodies.map((/** @type {any} */ body) => ({
      position: body.position.clone(), quaternion: body.quaternion.clone(),
    }));
    this._toolFrom = this._to === null ? new THREE.Vector3(...state.tool) : this.tool.clone();
    this._glideMs = gliding && this._to !== null ? Math.min(now - this._heardAt, LONGEST_GLIDE_MS) : 0;
    this._heardAt = now;
    // The next frame is seen a little later than it is begun: it already shows some of the motion.
    this._began = now - FRAME_MS;
    this._to = state.bodies;
    this._toolTo = new THREE.Vector3(...state.tool);
    this._extendTrail(this._toolTo);
  }

  /** Show the moment. @param {number} now ms @returns {boolean} whether poses are still gliding. */
  advance(now) {
    if (this._to === null) return false;
    const share = this._glideMs > 0 ? clamp((now - this._began) / this._glideMs) : 1;
    this._bodies.forEach((/** @type {any} */ body, /** @type {number} */ index) => {
      const pose = /** @type {number[][]} */ (this._to)[index];
      if (!pose) return;
      place(body, pose);
      const from = this._from[index];
      if (share === 1 || !from) return;
      body.position.lerpVectors(from.position, body.position, share);
      body.quaternion.slerpQuaternions(from.quaternion, body.quaternion.clone(), share);
    });
    this.tool.lerpVectors(this._toolFrom, this._toolTo, share);
    this._mark.position.copy(this.tool);
    this._plumb.position.set(this.tool.x, this.tool.y, this._height);
    this._plumb.scale.z = Math.max(this.tool.z - this._height, 1e-3);
    this._foot.position.set(this.tool.x, this.tool.y, this._height + 0.002);
    return share < 1;
  }

  /** A second arm that can be seen through, or none. @param {number[][] | null} bodies */
  shadow(bodies) {
    this._shadows ??= this._bodies.map((/** @type {any} */ body) => {
      const copy = body.clone();
      copy.traverse((/** @type {any} */ part) => {
        if (part.isMesh) part.material = this._shade;
      });
      this.scene.add(copy);
      return copy;
    });
    this._shadows.forEach((/** @type {any} */ shadow, /** @type {number} */ index) => {
      shadow.visible = bodies !== null;
      if (bodies) place(shadow, bodies[index]);
    });
  }

  /** Whether the tool is marked, and where it stands above the table. @param {boolean} shown */
  markTool(shown) {
    for (const part of [this._mark, this._plumb, this._foot]) part.visible = shown;
  }

  /** How sure the robot is of each goal: the size of its ring. @param {number[] | null} belief */
  believe(belief) {
    this._rings.forEach((/** @type {any} */ ring, /** @type {number} */ index) => {
      const share = belief?.[index] ?? 0;
      ring.visible = belief !== null;
      ring.scale.setScalar(0.03 + 0.06 * share);
      ring.material.opacity = 0.45 + 0.55 * share;
    });
  }

  /** The ball around the likeliest goal that help may hold the arm in. @param {number | null} radius m @param {number} goal */
  bound(radius, goal) {
    this._ball.visible = radius !== null && radius > 0 && goal >= 0;
    if (!this._ball.visible) return;
    this._ball.position.set(...this.goals[goal].position);
    this._ball.scale.setScalar(radius);
  }

  /** @param {boolean} shown */
  showTrail(shown) {
    this._trail.visible = shown;
  }

  clearTrail() {
    this._trail.count = 0;
    this._trailNext = 0;
    this._trailEnd = null;
  }

  /** Take the colours of the page as they are now. */
  repaint() {
    this.scene.background = new THREE.Color(colour("view"));
    this._floor.material.color.set(colour("table"));
    this._grid.material.color.set(colour("grid"));
    this._mark.material.color.set(colour("tool"));
    this._plumb.material.color.set(colour("tool"));
    this._foot.material.color.set(colour("tool"));
    this._trail.material.color.set(colour("trail"));
    this._ball.material.color.set(colour("ring"));
    this._shade.color.set(colour("way"));
    for (const solid of this._solids) solid.material.color.set(colour("table"));
    for (const ring of this._rings) ring.material.color.set(colour("ring"));
    for (const spot of this._spots) spot.material.color.set(colour("food"));
  }

  /** Points that a view must hold. @returns {any[]} */
  extent() {
    const points = this._bodies.map((/** @type {any} */ body) => body.position.clone());
    for (const goal of this.goals) points.push(new THREE.Vector3(...goal.position));
    points.push(this.tool.clone());
    return points;
  }

  /** What the arm must keep clear of; level planes are drawn as the table, with a grid of 10 cm. @param {any[]} obstacles */
  _addObstacles(obstacles) {
    this._solids = obstacles.map(obstacleOf).filter((/** @type {any} */ shape) => shape !== null);
    const level = obstacles.find((one) => one.type === "plane" && one.normal[2] > 0.99);
    const height = level ? level.point[2] : 0;
    this._floor = new THREE.Mesh(new THREE.PlaneGeometry(FLOOR_M, FLOOR_M), new THREE.MeshBasicMaterial());
    this._floor.position.set(0.35, 0, height - 0.002);
    const half = FLOOR_M / 2;
    const points = [];
    for (let at = -half; at < half + 1e-6; at += 0.1) points.push(at, -half, 0, at, half, 0, -half, at, 0, half, at, 0);
    const lines = new THREE.BufferGeometry();
    lines.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
    this._grid = new THREE.LineSegments(lines, new THREE.LineBasicMaterial());
    this._grid.position.set(0.35, 0, height);
    this._height = height;
    this.scene.add(this._floor, this._grid, ...this._solids);
  }

  _addTool() {
    this._mark = new THREE.Mesh(new THREE.SphereGeometry(0.014, 16, 12), new THREE.MeshBasicMaterial());
    const line = new THREE.CylinderGeometry(0.0022, 0.0022, 1, 6).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    this._plumb = new THREE.Mesh(line, new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.55 }));
    this._foot = new THREE.Mesh(new THREE.RingGeometry(0.016, 0.022, 24), new THREE.MeshBasicMaterial());
    this.scene.add(this._mark, this._plumb, this._foot);
  }

  _addGoals() {
    this._spots = this.goals.map((/** @type {any} */ goal) => {
      const spot = new THREE.Mesh(new THREE.SphereGeometry(0.016, 16, 12), new THREE.MeshLambertMaterial());
      spot.position.set(...goal.position);
      return spot;
    });
    this._rings = this.goals.map((/** @type {any} */ goal) => {
      const ring = new THREE.Mesh(
        new THREE.TorusGeometry(1, 0.07, 5, 36),
        new THREE.MeshBasicMaterial({ transparent: true }),
      );
      ring.position.set(...goal.position);
      // Faces whichever view is being drawn.
      ring.onBeforeRender = (/** @type {any} */ _renderer, /** @type {any} */ _scene, /** @type {any} */ camera) => {
        ring.quaternion.copy(camera.quaternion);
        ring.updateMatrixWorld(true);
      };
      return ring;
    });
    this._ball = new THREE.Mesh(
      new THREE.SphereGeometry(1, 24, 16),
      new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.18, depthWrite: false, side: THREE.DoubleSide }),
    );
    this._ball.visible = false;
    this.scene.add(...this._spots, ...this._rings, this._ball);
  }

  _addTrail() {
    const bead = new THREE.OctahedronGeometry(0.0045);
    this._trail = new THREE.InstancedMesh(bead, new THREE.MeshBasicMaterial(), TRAIL_POINTS);
    this._trail.frustumCulled = false;
    this.scene.add(this._trail);
    this.clearTrail();
  }

  /** @param {any} tool */
  _extendTrail(tool) {
    if (this._trailEnd && this._trailEnd.distanceTo(tool) < TRAIL_STEP_M) return;
    this._trailEnd = tool.clone();
    this._trail.setMatrixAt(this._trailNext, new THREE.Matrix4().makeTranslation(tool.x, tool.y, tool.z));
    this._trail.instanceMatrix.needsUpdate = true;
    this._trailNext = (this._trailNext + 1) % TRAIL_POINTS;
    this._trail.count = Math.max(this._trail.count, this._trailNext);
  }
}

/** @param {number} share */
function clamp(share) {
  return Math.min(Math.max(share, 0), 1);
}
