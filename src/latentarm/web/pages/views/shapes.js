/** From the geoms of a MuJoCo model to three.js meshes. */

import { THREE } from "../three/index.js";

/** @import {Geom, Obstacle} from "./scene_description.js" */
/** @typedef {Map<number, THREE.BufferGeometry>} Meshes geometries by number */

/**
 * A body: all its geoms together.
 *
 * @param {Geom[]} geoms
 * @param {Meshes} meshes
 */
export function groupOf(geoms, meshes) {
  const group = new THREE.Group();
  for (const geom of geoms) {
    const shape = shapeOf(geom, meshes);
    if (shape) group.add(shape);
  }
  return group;
}

/**
 * One geom, placed in its body.
 *
 * @param {Geom} geom
 * @param {Meshes} meshes
 * @returns {THREE.Mesh | null} null for a kind that is not drawn
 */
function shapeOf(geom, meshes) {
  const geometry = geometryOf(geom, meshes);
  if (geometry === null) return null;
  const mesh = new THREE.Mesh(geometry, materialOf(geom.rgba));
  place(mesh, [...geom.pos, ...geom.quat]);
  return mesh;
}

/** @param {Geom["rgba"]} rgba each in [0, 1] */
export function materialOf([red, green, blue, alpha]) {
  return new THREE.MeshLambertMaterial({
    color: new THREE.Color().setRGB(red, green, blue, THREE.SRGBColorSpace),
    transparent: alpha < 1,
    opacity: alpha,
  });
}

/**
 * Something that the arm must keep clear of; planes are drawn as the table.
 *
 * @param {Obstacle} obstacle
 */
export function obstacleOf(obstacle) {
  const material = new THREE.MeshLambertMaterial({ transparent: true, opacity: 0.6 });
  if (obstacle.type === "sphere") {
    const ball = new THREE.Mesh(new THREE.SphereGeometry(obstacle.radius, 24, 16), material);
    ball.position.set(...obstacle.centre);
    return ball;
  }
  if (obstacle.type === "capsule") {
    const [start, end] = [new THREE.Vector3(...obstacle.start), new THREE.Vector3(...obstacle.end)];
    const along = end.clone().sub(start);
    const rod = new THREE.Mesh(new THREE.CapsuleGeometry(obstacle.radius, along.length(), 8, 24), material);
    rod.position.copy(start).lerp(end, 0.5);
    rod.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
    return rod;
  }
  if (obstacle.type === "box") {
    const [a, b, c] = obstacle.half_extents;
    const box = new THREE.Mesh(new THREE.BoxGeometry(2 * a, 2 * b, 2 * c), material);
    place(box, [...obstacle.pos, ...obstacle.quat]);
    return box;
  }
  return null;
}

/** @param {Geom} geom @param {Meshes} meshes @returns {THREE.BufferGeometry | null} */
function geometryOf({ type, size, mesh }, meshes) {
  const [a, b, c] = size;
  switch (type) {
    case "sphere":
      return new THREE.SphereGeometry(a, 24, 16);
    case "ellipsoid":
      return new THREE.SphereGeometry(1, 24, 16).scale(a, b, c);
    case "capsule":
      return new THREE.CapsuleGeometry(a, 2 * b, 6, 18).rotateX(Math.PI / 2);
    case "cylinder":
      return new THREE.CylinderGeometry(a, a, 2 * b, 28).rotateX(Math.PI / 2);
    case "box":
      return new THREE.BoxGeometry(2 * a, 2 * b, 2 * c);
    case "mesh":
      return (mesh !== null && meshes.get(mesh)) || null;
    default:
      return null;
  }
}

/**
 * @param {THREE.Object3D} object
 * @param {number[]} pose x, y, z (m) and a quaternion w, x, y, z
 */
export function place(object, [x, y, z, w, i, j, k]) {
  object.position.set(x, y, z);
  object.quaternion.set(i, j, k, w);
}

/** A mesh as the server sends it: two counts, vertices and faces, little-endian. @param {ArrayBuffer} bytes */
export function meshGeometry(bytes) {
  const [vertices, faces] = new Uint32Array(bytes, 0, 2);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(bytes, 8, 3 * vertices), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes, 8 + 12 * vertices, 3 * faces), 1));
  geometry.computeVertexNormals();
  return geometry;
}
