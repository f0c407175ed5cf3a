/** From the geoms of a MuJoCo model to three.js meshes. */

import * as THREE from "../three/three.module.min.js";
import { coarser } from "./coarser.js";
import { ROUND, SOFTWARE } from "./fineness.js";
import { merged } from "./merged.js";

/** @import {Geom, Plane, Solid} from "./scene_description.js" */
/** @typedef {Map<number, THREE.BufferGeometry>} Meshes geometries by number */

/** A body: all its geoms together, in as few calls to draw as can be. @param {Geom[]} geoms @param {Meshes} meshes @param {boolean} [food] with its grain */
export function groupOf(geoms, meshes, food = false) {
  return standing([{ geoms, pose: [0, 0, 0, 1, 0, 0, 0] }], meshes, food);
}

/** Several bodies that stay where they are, as one. @param {{geoms: Geom[], pose: number[]}[]} bodies @param {Meshes} meshes @param {boolean} [food] */
export function standing(bodies, meshes, food = false) {
  const parts = bodies.flatMap(({ geoms, pose }) => geoms.flatMap((geom) => {
    const geometry = geometryOf(geom, meshes);
    const at = matrixOf(pose).multiply(matrixOf([...geom.pos, ...geom.quat]));
    return geometry ? [{ geometry, at, colour: colourOf(geom.rgba), alpha: geom.rgba[3] }] : [];
  }));
  const group = new THREE.Group();
  for (const opacity of new Set(parts.map(({ alpha }) => alpha))) {
    const material = new THREE.MeshLambertMaterial({ vertexColors: true, transparent: opacity < 1, opacity, map: food ? grain() : null });
    group.add(new THREE.Mesh(merged(parts.filter(({ alpha }) => alpha === opacity)), material));
  }
  return group;
}

const GRAIN_PX = 64;
const SPECKS = 260;
/** @type {THREE.CanvasTexture<OffscreenCanvas> | null} */
let made = null;

/** Light and dark specks, which nothing smooth and clean has. */
function grain() {
  if (made) return made;
  const canvas = new OffscreenCanvas(GRAIN_PX, GRAIN_PX);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d"));
  context.fillStyle = "#e8e8e8";
  context.fillRect(0, 0, GRAIN_PX, GRAIN_PX);
  for (let speck = 0; speck < SPECKS; speck += 1) {
    // Scattered, and the same on every page.
    const [x, y] = [0.754877666, 0.569840296].map((step) => GRAIN_PX * ((speck * step) % 1));
    context.fillStyle = speck % 2 ? "#ffffff" : "#c4bdb2";
    context.beginPath();
    context.arc(x, y, 1 + (speck % 3), 0, 2 * Math.PI);
    context.fill();
  }
  made = new THREE.CanvasTexture(canvas);
  return made;
}

/** @param {number[]} pose x, y, z (m) and a quaternion w, x, y, z */
function matrixOf([x, y, z, w, i, j, k]) {
  return new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), new THREE.Quaternion(i, j, k, w), new THREE.Vector3(1, 1, 1));
}

/** @param {Geom["rgba"]} rgba each in [0, 1] */
function colourOf([red, green, blue]) {
  return new THREE.Color().setRGB(red, green, blue, THREE.SRGBColorSpace);
}

/** @param {Geom["rgba"]} rgba each in [0, 1] */
export function materialOf(rgba) {
  return new THREE.MeshLambertMaterial({ color: colourOf(rgba), transparent: rgba[3] < 1, opacity: rgba[3] });
}

/** Something solid where it stands. @template {THREE.Material} M @param {Solid} solid @param {M} material @returns {THREE.Mesh<THREE.BufferGeometry, M>} */
export function solidOf(solid, material) {
  if (solid.type === "sphere") {
    const ball = new THREE.Mesh(ballOf(solid.radius), material);
    ball.position.set(...solid.centre);
    return ball;
  }
  if (solid.type === "capsule") {
    const [start, end] = [new THREE.Vector3(...solid.start), new THREE.Vector3(...solid.end)];
    const along = end.clone().sub(start);
    const rod = new THREE.Mesh(rodOf(solid.radius, along.length()), material);
    rod.position.copy(start).lerp(end, 0.5);
    rod.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), along.normalize());
    return rod;
  }
  const [a, b, c] = solid.half_extents;
  const box = new THREE.Mesh(new THREE.BoxGeometry(2 * a, 2 * b, 2 * c), material);
  place(box, [...solid.pos, ...solid.quat]);
  return box;
}

/** A square piece of a plane. @template {THREE.Material} M @param {Plane} plane @param {number} size m @param {M} material */
export function sheetOf({ point, normal }, size, material) {
  const sheet = new THREE.Mesh(new THREE.PlaneGeometry(size, size), material);
  sheet.position.set(...point);
  sheet.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), new THREE.Vector3(...normal));
  return sheet;
}

/** A mesh of fewer faces needs no others. */
const MANY_FACES = 400;

/** @param {Geom} geom @param {Meshes} meshes @returns {THREE.BufferGeometry | null} null for a kind that is not drawn */
function geometryOf({ type, size, mesh }, meshes) {
  const [a, b, c] = size;
  switch (type) {
    case "sphere":
      return ballOf(a);
    case "ellipsoid":
      return ballOf(1).scale(a, b, c);
    case "capsule":
      return rodOf(a, 2 * b);
    case "cylinder":
      return new THREE.CylinderGeometry(a, a, 2 * b, Math.round(1.4 * ROUND.about)).rotateX(Math.PI / 2);
    case "box":
      return new THREE.BoxGeometry(2 * a, 2 * b, 2 * c);
    case "mesh":
      return (mesh !== null && meshes.get(mesh)) || null;
    default:
      return null;
  }
}

/** @param {number} radius */
export function ballOf(radius) {
  return new THREE.SphereGeometry(radius, ROUND.about, ROUND.along);
}

/** A capsule along z. @param {number} radius @param {number} length without its caps */
function rodOf(radius, length) {
  return new THREE.CapsuleGeometry(radius, length, ROUND.cap, ROUND.about).rotateX(Math.PI / 2);
}

/** @param {THREE.Object3D} object @param {number[]} pose x, y, z (m) and a quaternion w, x, y, z */
export function place(object, [x, y, z, w, i, j, k]) {
  object.position.set(x, y, z);
  object.quaternion.set(i, j, k, w);
}

/** The pose in which it stands now. @param {THREE.Object3D} object */
export function stanceOf({ position, quaternion }) {
  return { position: position.clone(), quaternion: quaternion.clone() };
}

/** Put it a share of the way from a stance to a pose. @param {THREE.Object3D} object @param {ReturnType<typeof stanceOf>} from @param {number[]} pose @param {number} share */
export function glide(object, from, pose, share) {
  place(object, pose);
  if (share === 1) return;
  object.position.lerpVectors(from.position, object.position, share);
  object.quaternion.slerpQuaternions(from.quaternion, object.quaternion.clone(), share);
}

/** A mesh as the server sends it: two counts, vertices and faces, little-endian. @param {ArrayBuffer} bytes */
export function meshGeometry(bytes) {
  const [vertices, faces] = new Uint32Array(bytes, 0, 2);
  const all = { positions: new Float32Array(bytes, 8, 3 * vertices), faces: new Uint32Array(bytes, 8 + 12 * vertices, 3 * faces) };
  const drawn = SOFTWARE && faces > MANY_FACES ? coarser(all.positions, all.faces) : all;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(drawn.positions, 3));
  geometry.setIndex(new THREE.BufferAttribute(drawn.faces, 1));
  geometry.computeVertexNormals();
  return geometry;
}
