/** What each direction will do: the tool's paths over the next second, for this person, and in words. */

import { DIRECTIONS } from "../inputs/dpad.js";

/** @typedef {import("../inputs/dpad.js").Direction} Direction */

/** How each is marked, in the views and in the list. @type {Record<Direction, {mark: string, label: string}>} */
export const LOOKS = {
  up: { mark: "↑", label: "Up" },
  down: { mark: "↓", label: "Down" },
  left: { mark: "←", label: "Left" },
  right: { mark: "→", label: "Right" },
};
/**
 * The paths for the person's own directions, out of those for full inputs along each axis.
 *
 * @param {Record<Direction, number[][]> | null} ghosts what the server says
 * @param {number[]} tool where the paths begin, m
 * @param {(x: number, y: number) => number[]} shaped from stick to what is sent
 * @returns {Record<Direction, number[][] | null>}
 */
export function personal(ghosts, tool, shaped) {
  /** @type {any} */
  const paths = {};
  for (const [direction, [x, y]] of Object.entries(DIRECTIONS)) {
    const [across = 0, along = 0] = shaped(x, y);
    const size = Math.max(Math.abs(across), Math.abs(along));
    const sent = Math.abs(across) >= Math.abs(along) ? (across > 0 ? "right" : "left") : along > 0 ? "up" : "down";
    const path = size > 0 ? ghosts?.[sent] ?? null : null;
    paths[direction] = path && shortened([tool, ...path], size);
  }
  return paths;
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

/**
 * The list beside the views: the same in words.
 *
 * @param {HTMLElement} list
 */
export function listGhosts(list) {
  const rows = Object.entries(LOOKS).map(([direction, { mark, label }]) => {
    const item = document.createElement("li");
    item.dataset.ghost = direction;
    const sign = Object.assign(document.createElement("span"), { className: "ghost-mark", textContent: mark });
    sign.setAttribute("aria-hidden", "true");
    const words = document.createElement("span");
    item.append(sign, Object.assign(document.createElement("span"), { textContent: label }), words);
    list.append(item);
    return { direction, item, words };
  });
  return {
    /**
     * @param {Record<Direction, number[][] | null>} paths
     * @param {Direction[]} pressed
     * @param {(motion: number[]) => string} say
     */
    show(paths, pressed, say) {
      for (const { direction, item, words } of rows) {
        const path = paths[/** @type {Direction} */ (direction)];
        const text = path === null ? "–" : say(path[path.length - 1].map((end, axis) => end - path[0][axis]));
        if (words.textContent !== text) words.textContent = text;
        item.dataset.pressed = String(pressed.includes(/** @type {Direction} */ (direction)));
      }
    },
  };
}
