/** Predictions for each direction: the tool's paths over the next second, for this person, and in words. */

import { DIRECTIONS, DIRECTION_NAMES } from "../inputs/deflection.js";
import { byId, setText } from "../layout/dom.js";

/** Points of the tool, m, for each direction; null where nothing is known. @typedef {Record<Direction, number[][] | null>} Paths */

/** The ring has a row for each of so many directions: x, y, z (m) and a quaternion w, x, y, z; none where nothing is known. @typedef {{paths: Paths, ring: number[][]}} Predicted */

/** @type {Predicted} */
export const NOTHING_PREDICTED = { paths: { up: null, down: null, left: null, right: null }, ring: [] };

/** How each is marked, in the views and in the list. @type {Record<Direction, string>} */
export const MARKS = { up: "↑", down: "↓", left: "←", right: "→" };

/** The paths of the person's own directions. @param {State["ghosts"]} ghosts of full inputs @param {number[]} tool now, m @param {Shaped} shaped */
export function personalPaths(ghosts, tool, shaped) {
  const paths = { ...NOTHING_PREDICTED.paths };
  for (const direction of DIRECTION_NAMES) {
    const [across = 0, along = 0] = shaped(...DIRECTIONS[direction]);
    const size = Math.max(Math.abs(across), Math.abs(along));
    const sent = Math.abs(across) >= Math.abs(along) ? (across > 0 ? "right" : "left") : along > 0 ? "up" : "down";
    if (ghosts?.[sent].length && size > 0) paths[direction] = shortened([tool, ...ghosts[sent]], size);
  }
  return paths;
}

/** The ring of the person's stick, counter-clockwise from the right. @param {State["ghosts"]} ghosts @param {number[]} tool now, m @param {Shaped} shaped */
export function personalRing(ghosts, tool, shaped) {
  const ring = ghosts?.ring ?? [];
  const turn = (2 * Math.PI) / ring.length;
  // A stick of one axis has none: its two arrows say it all.
  return shaped(1, 0).length < 2 ? [] : ring.map((_, direction) => {
    const [across, along] = shaped(Math.cos(direction * turn), Math.sin(direction * turn));
    const size = Math.min(Math.hypot(across, along), 1);
    const sent = ring[(Math.round(Math.atan2(along, across) / turn) + ring.length) % ring.length];
    return [...tool.map((from, axis) => from + size * (sent[axis] - from)), ...sent.slice(3)];
  });
}

/** The first share of a path: a smaller input goes less far in the same time. @param {number[][]} path @param {number} share */
function shortened(path, share) {
  const last = (path.length - 1) * Math.min(share, 1);
  const whole = Math.floor(last);
  const points = path.slice(0, whole + 1);
  if (last > whole) {
    points.push(path[whole].map((from, axis) => from + (last - whole) * (path[whole + 1][axis] - from)));
  }
  return points.length > 1 ? points : path.slice(0, 2);
}

/** The list next to the views: the same in words. @param {Paths} paths @param {Direction[]} pressed @param {(motion: number[], direction: Direction) => string} describe */
export function showPredictions(paths, pressed, describe) {
  for (const direction of DIRECTION_NAMES) {
    const [item, path] = [byId(`ghost-${direction}`), paths[direction]];
    setText(item.children[2], path === null ? "–" : describe(displacement(path), direction));
    item.dataset.pressed = String(pressed.includes(direction));
  }
}

/** From the first point of a path to its last, m. @param {number[][]} path */
export function displacement(path) {
  return path[path.length - 1].map((end, axis) => end - path[0][axis]);
}
