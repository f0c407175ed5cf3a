/** How gamepads are used: what each button does, which axes drive, which way, and where they rest. */

/** @typedef {"stop" | "enable" | "gripper" | "nextMode"} Use */
/** @typedef {{uses: (Use | "")[], axes: number, at: number[], way: number[], rest: number[], dead: number}} Mapping
 *   `uses` of each button; how many `axes` there are; of right and up: `at` which axis, which `way` it grows (1 or -1) and
 *   where its `rest` is, in [-0.5, 0.5]; `dead` is how far from there the stick may rest, in [0, 0.5] */

/** Of gamepads whose buttons the browser knows: the first four, and the shoulders. @type {Mapping["uses"]} */
const STANDARD = ["enable", "stop", "gripper", "", "nextMode", "nextMode"];
/** The first two axes, as the Gamepad API recommends, and every button stops. Under no id: so is every gamepad without a mapping. @type {Mapping} */
export const EVERY_STOP = { at: [0, 1], way: [1, -1], rest: [0, 0], dead: 0.08, axes: 2, uses: ["stop"] };
/** An axis that rests further from its middle is a trigger's, and no push; one that is pushed is so far from where it rests. */
const [FARTHEST_REST, PUSHED] = [0.5, 0.6];
const MOST = { pads: 10, id: 120, buttons: 64 };
/** Under which it is known. */
export const idOf = (/** @type {Gamepad} */ { id }) => id.slice(0, MOST.id);
const isOwn = (/** @type {Mapping | undefined} */ mapping, /** @type {Gamepad} */ pad) => mapping?.uses.length === pad.buttons.length && mapping.axes === pad.axes.length;

/** As browsers call it, without the maker's numbers. */
export const nameOf = (/** @type {Gamepad} */ { id }) => id.replace(/ ?\(.*$|^([0-9a-f]{4}-){2}/g, "") || id;

/** Whether nobody knows its buttons: the person has not mapped it, and the browser has no layout for it. @param {Record<string, Mapping>} pads @param {Gamepad} pad */
export function isGuessed(pads, pad) {
  return !isOwn(pads[idOf(pad)], pad) && (pad.mapping !== "standard" || "" in pads);
}

/** The person's own mapping of it, or the usual one. @param {Record<string, Mapping>} pads @param {Gamepad} pad @returns {Mapping} */
export function mappingOf(pads, pad) {
  if (isOwn(pads[idOf(pad)], pad)) return pads[idOf(pad)];
  const guessed = isGuessed(pads, pad);
  return { ...EVERY_STOP, axes: pad.axes.length, uses: pad.buttons.map((_, number) => guessed ? "stop" : STANDARD[number] ?? "") };
}

/** A button gets a use, and no other has it any more; undefined where Stop would be left without. @param {Mapping} mapping @param {Use} use @param {number} number */
export function withUse(mapping, use, number) {
  const uses = mapping.uses.map((one, at) => at === number ? use : one === use ? "" : one);
  return uses.includes("stop") ? { ...mapping, uses } : undefined;
}

/** An axis that is pushed right (0) or up (1) gets that use; null before one is. @param {Mapping} mapping @param {number} which @param {number[][]} atRest samples of all axes @param {readonly number[]} axes @returns {Mapping | null} */
export function withPush(mapping, which, atRest, axes) {
  const centre = axes.map((_, axis) => atRest.reduce((sum, one) => sum + one[axis], 0) / atRest.length);
  const off = axes.map((value, axis) => Math.abs(centre[axis]) <= FARTHEST_REST ? value - centre[axis] : 0);
  const axis = off.map(Math.abs).indexOf(Math.max(...off.map(Math.abs)));
  if (!(Math.abs(off[axis]) >= PUSHED)) return null;
  // Where the other way was on this axis, it changes places.
  const at = mapping.at.map((other, one) => one === which ? axis : other === axis ? mapping.at[which] : other);
  const rest = at.map((one) => Math.min(Math.max(centre[one], -FARTHEST_REST), FARTHEST_REST));
  const stray = Math.max(...atRest.flatMap((one) => at.map((number) => Math.abs(one[number] - centre[number]))));
  const dead = Math.min(Math.max(2 * stray, EVERY_STOP.dead), FARTHEST_REST);
  return { ...mapping, at, way: mapping.way.with(which, Math.sign(off[axis])), rest, dead };
}

/** The push, right and up, in [-1, 1]. @param {Mapping} mapping @param {readonly number[]} axes */
export function stickOf({ at, way, rest }, axes) {
  return at.map((axis, which) => {
    const off = Math.min(Math.max(axes[axis] ?? 0, -1), 1) - rest[which];
    return (way[which] * off) / (1 - Math.sign(off) * rest[which]);
  });
}

/** The stored mappings that make sense. @param {unknown} stored @returns {Record<string, Mapping>} */
export function validMappings(stored) {
  return Object.fromEntries(Object.entries(stored ?? {}).filter(([id, one]) => id.length <= MOST.id && isMapping(one)).slice(-MOST.pads));
}

/** @param {any} one */
function isMapping(one) {
  const two = (/** @type {any} */ values, /** @type {(value: number) => boolean} */ isFit) => Array.isArray(values) && values.length === 2 && values.every(isFit);
  const within = (/** @type {any} */ value, /** @type {number} */ low) => typeof value === "number" && value >= low && value <= FARTHEST_REST;
  return Array.isArray(one?.uses) && one.uses.length <= MOST.buttons && one.uses.includes("stop") && one.uses.every((/** @type {any} */ use) => STANDARD.includes(use))
    && two(one.at, (axis) => Number.isInteger(axis) && axis >= 0 && axis < one.axes) && one.at[0] !== one.at[1]
    && two(one.way, (way) => way === 1 || way === -1) && two(one.rest, (rest) => within(rest, -FARTHEST_REST)) && within(one.dead, 0);
}
