/** Several shapes as one, each in its place and colour: one call draws them all. */

import * as THREE from "../three/three.module.min.js";

/** @param {{geometry: THREE.BufferGeometry, at: THREE.Matrix4, colour: THREE.Color}[]} parts indexed geometries with normals, and where they are */
export function merged(parts) {
  const vertices = parts.reduce((sum, { geometry }) => sum + geometry.attributes.position.count, 0);
  const corners = parts.reduce((sum, { geometry }) => sum + indexOf(geometry).count, 0);
  const [positions, normals, colours] = [1, 2, 3].map(() => new Float32Array(3 * vertices));
  const places = new Float32Array(2 * vertices);
  const index = new Uint32Array(corners);
  let [vertex, corner] = [0, 0];
  for (const { geometry, at, colour } of parts) {
    const moved = geometry.clone().applyMatrix4(at);
    positions.set(moved.attributes.position.array, 3 * vertex);
    normals.set(moved.attributes.normal.array, 3 * vertex);
    if (geometry.attributes.uv) places.set(geometry.attributes.uv.array, 2 * vertex);
    const own = indexOf(moved).array;
    for (let one = 0; one < own.length; one += 1) index[corner + one] = own[one] + vertex;
    corner += own.length;
    const { count } = moved.attributes.position;
    for (let one = vertex; one < vertex + count; one += 1) colour.toArray(colours, 3 * one);
    vertex += count;
  }
  const all = new THREE.BufferGeometry();
  all.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  all.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
  all.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  all.setAttribute("uv", new THREE.BufferAttribute(places, 2));
  all.setIndex(new THREE.BufferAttribute(index, 1));
  return all;
}

/** @param {THREE.BufferGeometry} geometry @returns {THREE.BufferAttribute} @throws {Error} where it has none. */
function indexOf({ index }) {
  if (index === null) throw new Error("only indexed shapes can be merged");
  return index;
}
