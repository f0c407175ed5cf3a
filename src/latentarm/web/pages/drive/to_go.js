/** The remaining way to where the tool is to be next: for each pair of directions, which way to push and how far. */

import { DIRECTIONS, DIRECTION_NAMES } from "../inputs/deflection.js";
import { byId, create, setText } from "../layout/dom.js";
import { say, sayNumber } from "../layout/words.js";
import { displacement } from "../views/predictions.js";

/** @import {ToGo} from "../connection/messages.js" */

/** @typedef {Words & {choice: string}} Next what brings the task on, and the choice of a switch for it */
/** @typedef {{of: "shift_m" | "turn_rad", axis: number}} Part one of the six ways in which the tool can move */

/** The parts that the two axes of each pair move. @type {Record<string, [Part, Part]>} */
const PAIRS = {
  "x-y": [{ of: "shift_m", axis: 0 }, { of: "shift_m", axis: 1 }],
  "z-yaw": [{ of: "shift_m", axis: 2 }, { of: "turn_rad", axis: 2 }],
  "roll-pitch": [{ of: "turn_rad", axis: 0 }, { of: "turn_rad", axis: 1 }],
};
/** Less than this need not be driven, m and rad. */
const LEAST = { shift_m: 0.003, turn_rad: 0.05 };
/** From here on, tenths of a centimetre say nothing. */
const WHOLE_CM = 10;
/** Smaller ways come after all others, in multiples of what need not be driven. */
const LARGE = 4;
const WORDS_MS = 250;

/** A prediction that brings the tool nearer by less is not worth a push, m. */
const NEARER_M = 0.01;

/** The part that a direction moves, and which way: 1 or -1. @param {string} pair @param {number[]} sent what is sent for it */
export function movedPart(pair, sent) {
  const axis = Math.abs(sent[1] ?? 0) > Math.abs(sent[0]) ? 1 : 0;
  return { part: PAIRS[pair][axis], way: Math.sign(sent[axis]) };
}

/**
 * The remaining way in one pair of directions; nothing where it need not be driven.
 *
 * @param {ToGo} toGo
 * @param {string} pair its name
 * @param {(x: number, y: number) => number[]} shaped from stick to what is sent in it
 * @returns {{direction: Direction, text: string, size: number, turn: number}[]} `size`: in multiples of what need not be
 *   driven; `turn`: 0 for what comes first, up and back to the arm's base, to 2 for what comes last, down and forward
 */
export function leftToGo(toGo, pair, shaped) {
  return DIRECTION_NAMES.flatMap((direction) => {
    const { part, way } = movedPart(pair, shaped(...DIRECTIONS[direction]));
    const far = way * toGo[part.of][part.axis];
    if (far < LEAST[part.of]) return [];
    const name = say(`directions.${direction}`);
    const size = far / LEAST[part.of];
    if (part.of === "turn_rad") return [{ direction, size, turn: 1, text: say("to_go.turn", { direction: name, degrees: Math.round((180 * far) / Math.PI) }) }];
    const centimetres = sayNumber(100 * far, 100 * far < WHOLE_CM ? 1 : 0);
    const turn = 1 + [way, 0, -way][part.axis];
    return [{ direction, size, turn, text: say("to_go.length", { direction: name, centimetres }) }];
  });
}

/** @param {Direction} direction @param {string} way @param {boolean} switches whether a switch chooses directions @returns {Next} */
function push(direction, way, switches) {
  return { choice: direction, key: switches ? "status.go_switch" : "status.go", parameters: { way } };
}

/**
 * What brings the tool on along straight lines: the furthest way in the pair in use, or else another pair.
 *
 * @param {ReturnType<typeof leftToGo>[]} ways of each pair
 * @param {number} axes the pair in use
 * @param {string[]} pairs their names
 * @param {boolean} switches
 * @returns {Next | null}
 */
export function straightOn(ways, axes, pairs, switches) {
  const rank = (/** @type {(typeof ways)[0][0]} */ { size, turn }) => turn + (size < LARGE ? 3 : 0);
  const [first] = [...ways[axes]].sort((one, other) => rank(one) - rank(other) || other.size - one.size);
  if (first) return push(first.direction, first.text, switches);
  const other = ways.findIndex((left) => left.length > 0);
  return other < 0 ? null : { choice: "mode", key: "status.next_pair", parameters: { pair: say(/** @type {WordKey} */ (`axes.${pairs[other]}`)) } };
}

/** By learned motions: the direction that leads nearest to where the tool is to be. @param {ToGo} toGo @param {Paths} paths @param {boolean} switches */
export function learnedOn(toGo, paths, switches) {
  const left = (/** @type {number[][]} */ path) => Math.hypot(...displacement(path).map((moved, axis) => toGo.shift_m[axis] - moved));
  const known = DIRECTION_NAMES.flatMap((direction) => (paths[direction] ? [{ direction, left: left(paths[direction]) }] : []));
  const [best] = known.sort((one, other) => one.left - other.left);
  if (!best || best.left > Math.hypot(...toGo.shift_m) - NEARER_M) return null;
  // How far is said above the view: the arm goes there on a curve, and not this far this way.
  return push(best.direction, say(`directions.${best.direction}`), switches);
}

/**
 * The list under the task, and what to choose next.
 *
 * @param {Connection} connection
 * @param {(axes: number, x: number, y: number) => number[]} shaped from stick to what is sent in a pair
 * @param {() => boolean} switches whether a switch chooses directions
 * @returns `next`: what brings the task on, in the numbers of the list; `left`: how far it is in a direction of straight lines,
 *   m or rad, negative beyond; null where nothing is to be driven so
 */
export function attachToGo(connection, shaped, switches) {
  const list = byId("to-go");
  let wordsAt = -Infinity;
  let begun = "";
  /** @type {ReturnType<typeof leftToGo>[]} */
  let ways = [];

  connection.addEventListener("welcome", () => {
    const { end_effector_modes } = /** @type {NonNullable<Connection["welcome"]>} */ (connection.welcome);
    list.replaceChildren(...end_effector_modes.map((name) => {
      const pair = say("to_go.pair", { pair: say(/** @type {WordKey} */ (`axes.${name}`)) });
      return create("li", {}, create("span", { className: "to-go-pair", textContent: pair }), create("span"), create("span"));
    }));
    wordsAt = -Infinity;
  });
  connection.addEventListener("state", () => {
    const { state, welcome } = connection;
    const toGo = state?.task.to_go ?? null;
    // Learned motions have no such directions.
    list.hidden = toGo === null || state?.mode !== "end_effector";
    if (!state || !welcome || toGo === null || list.hidden) return;
    // Another pair or step is announced at once.
    const now = JSON.stringify([state.task.choice, state.task.done, state.task.lost, state.axes]);
    if (now === begun && performance.now() - wordsAt < WORDS_MS) return;
    begun = now;
    wordsAt = performance.now();
    ways = welcome.end_effector_modes.map((name, axes) => leftToGo(toGo, name, (x, y) => shaped(axes, x, y)));
    const next = ways[state.axes].length || toGo.gripper ? -1 : ways.findIndex((left) => left.length > 0);
    welcome.end_effector_modes.forEach((_, axes) => {
      const left = ways[axes];
      byId("axes").querySelectorAll("label")[axes].dataset.next = String(axes === next);
      const item = list.children[axes];
      if (axes === state.axes) item.setAttribute("aria-current", "true");
      else item.removeAttribute("aria-current");
      const [, first, second] = item.children;
      [first, second].forEach((line, index) => {
        const one = left[index];
        setText(line, one?.text ?? (index === 0 ? "✓" : ""));
        /** @type {HTMLElement} */ (line).dataset.ghost = one?.direction ?? "";
      });
    });
  });
  /** Where the tool was when the server looked last: it tells a turn less often than a place. */
  let looked = "";
  let from = [0, 0, 0];
  const left = (/** @type {Direction} */ direction) => {
    const { state, welcome } = connection;
    const toGo = state?.task.to_go ?? null;
    if (!state || !welcome || toGo === null || state.mode !== "end_effector") return null;
    const look = JSON.stringify(toGo);
    if (look !== looked) [looked, from] = [look, state.tool];
    const { part: { of, axis }, way } = movedPart(welcome.end_effector_modes[state.axes], shaped(state.axes, ...DIRECTIONS[direction]));
    return way * (toGo[of][axis] - (of === "shift_m" ? state.tool[axis] - from[axis] : 0));
  };
  /** @returns {Next | null} */
  const next = (/** @type {Paths | null} */ paths) => {
    const { state, welcome } = connection;
    const toGo = state?.task.to_go ?? null;
    if (!state || !welcome || toGo === null || state.task.outcome !== null) return null;
    if (toGo.gripper) return { choice: "gripper", key: `to_go.gripper_${toGo.gripper}` };
    if (state.mode !== "end_effector") return paths && learnedOn(toGo, paths, switches());
    return ways[state.axes] ? straightOn(ways, state.axes, welcome.end_effector_modes, switches()) : null;
  };
  return { next, left };
}
