/** A mesh with fewer faces, for computers without a graphics processor: vertices that are close together become one. */

/** How far apart vertices are that stay apart, m; in a small mesh this share of its longest side. */
const CELL_M = 0.012;
const CELL_SHARE = 1 / 12;

/**
 * @param {Float32Array} positions x, y, z of each vertex, m
 * @param {Uint32Array} faces three vertices of each
 * @returns {{positions: Float32Array, faces: Uint32Array}} each vertex in the middle of those that it stands for
 */
export function coarser(positions, faces) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  positions.forEach((value, at) => {
    low[at % 3] = Math.min(low[at % 3], value);
    high[at % 3] = Math.max(high[at % 3], value);
  });
  const cell = Math.min(CELL_M, CELL_SHARE * Math.max(...high.map((most, axis) => most - low[axis])));
  /** Number of the vertex of each cell. @type {Map<string, number>} */
  const numbers = new Map();
  /** @type {number[]} */
  const sums = [];
  /** @type {number[]} */
  const counts = [];
  const becomes = Uint32Array.from({ length: positions.length / 3 }, (_, vertex) => {
    const place = [0, 1, 2].map((axis) => positions[3 * vertex + axis]);
    const key = place.map((value, axis) => Math.floor((value - low[axis]) / cell)).join();
    const number = numbers.get(key) ?? numbers.size;
    numbers.set(key, number);
    place.forEach((value, axis) => {
      sums[3 * number + axis] = (sums[3 * number + axis] ?? 0) + value;
    });
    counts[number] = (counts[number] ?? 0) + 1;
    return number;
  });
  /** @type {number[]} */
  const left = [];
  for (let face = 0; face < faces.length; face += 3) {
    const [a, b, c] = [becomes[faces[face]], becomes[faces[face + 1]], becomes[faces[face + 2]]];
    if (a !== b && b !== c && c !== a) left.push(a, b, c);
  }
  return { positions: Float32Array.from(sums, (sum, at) => sum / counts[Math.floor(at / 3)]), faces: Uint32Array.from(left) };
}
