/** What exercises show of a hand, and the settings that follow; undefined where there is too little to go by. Times are in s. */

import { TremorFilter } from "../inputs/tremor.js";

/** @typedef {[number, number, number]} Sample a push, right and up, in [-1, 1], and when */

/** So much of a hold is the way there. */
const SETTLING_S = 1;
/** Fewer show nothing. */
const [FEWEST_SAMPLES, FEWEST_PRESSES] = [50, 6];
/** So much of what a hand does at rest is in the dead zone, which has these bounds. */
const [COVERED, LEAST_DEAD, MOST_DEAD] = [0.99, 0.05, 0.3];
/** Shaking by so much of a full push does not matter. */
export const STEADY = 0.03;
const [SLOWEST_HZ, FASTEST_HZ, STEP_HZ] = [3, 12, 0.25];
const LEAST_REACH = 0.4;
/** The time to press is this share of a good scan time (Simpson, Koester and LoPresti, Assistive Technology 19, 2007). */
const RULE = 0.65;
const [LEAST_DWELL_S, MOST_DWELL_S, MOST_ACCEPT_S, MOST_RELEASE_S] = [0.4, 5, 0.3, 1];
/** A touch is shorter than this share of a usual press, and a press must be held for this share of the shortest. */
const TOUCH = 0.5;

/** The value that this share of all does not exceed; NaN of none. @param {number[]} values @param {number} share */
export function quantile(values, share) {
  return values.toSorted((one, other) => one - other)[Math.max(Math.ceil(share * values.length), 1) - 1] ?? NaN;
}

/** @param {number} value @param {number} step @param {(value: number) => number} [way] to the step below or above */
function rounded(value, step, way = Math.ceil) {
  return Number((way(value / step) * step).toFixed(2));
}

/** @param {Sample[]} hold */
export function settled(hold) {
  const held = hold.filter(([, , at]) => at >= hold[0][2] + SETTLING_S);
  return held.length < FEWEST_SAMPLES ? [] : held;
}

/** How far a hand at rest strays. @param {Sample[]} rest */
export function driftOf(rest) {
  return quantile(settled(rest).map(([x, y]) => Math.hypot(x, y)), COVERED);
}

/** @param {Sample[]} rest */
export function deadZoneFor(rest) {
  return settled(rest).length ? Math.min(Math.max(rounded(driftOf(rest), 0.05), LEAST_DEAD), MOST_DEAD) : undefined;
}

/** The strongest shaking: how often, Hz, and how far to either side. @param {Sample[]} hold */
export function shakingOf(hold) {
  const samples = settled(hold);
  const [from, to] = [samples[0]?.[2], samples.at(-1)?.[2] ?? 0];
  const mean = [0, 1].map((axis) => samples.reduce((sum, one) => sum + one[axis], 0) / samples.length);
  // By Hann's window the way that a hand drifts is not taken for shaking.
  const window = samples.map(([, , at]) => 1 - Math.cos((2 * Math.PI * (at - from)) / (to - from)));
  const whole = window.reduce((sum, one) => sum + one, 0);
  let found = { hz: 0, size: 0 };
  for (let hz = SLOWEST_HZ; hz <= FASTEST_HZ; hz += STEP_HZ) {
    const parts = [0, 1].flatMap((axis) => [Math.cos, Math.sin].map((wave) =>
      samples.reduce((sum, one, at) => sum + window[at] * (one[axis] - mean[axis]) * wave(2 * Math.PI * hz * (one[2] - from)), 0)));
    const size = (2 * Math.hypot(...parts)) / whole;
    if (size > found.size) found = { hz, size };
  }
  return found;
}

/** The weakest steadying under which no hold shakes. @param {Sample[][]} holds @returns {Values["tremor"] | undefined} */
export function tremorFor(holds) {
  if (!holds.length || holds.some((hold) => !settled(hold).length)) return undefined;
  return /** @type {const} */ (["off", "light", "medium"]).find((strength) => holds.every((hold) => {
    const filter = new TremorFilter();
    return shakingOf(hold.map(([x, y, at]) => [...filter.steady(strength, x, y, at), at])).size <= STEADY;
  })) ?? "strong";
}

/** How far counts as a full push, so that each of the four directions reaches it. @param {number[]} ranges */
export function reachFor(ranges) {
  const least = Math.min(...ranges, 1);
  return ranges.length === 4 && least > 0 ? Math.max(rounded(least, 0.05, Math.floor), LEAST_REACH) : undefined;
}

/** How long a choice is lit; undefined also where no time is long enough. @param {number[]} reactions from lit to pressed */
export function dwellFor(reactions) {
  const mean = reactions.reduce((sum, one) => sum + one, 0) / reactions.length;
  const dwell = Math.max(rounded(Math.max(mean / RULE, quantile(reactions, 0.9)), 0.1), LEAST_DWELL_S);
  return reactions.length >= FEWEST_PRESSES && dwell <= MOST_DWELL_S ? dwell : undefined;
}

/** How long a press must be held, so that touches do not count and presses do. @param {number[]} holds @param {number} now what is set */
export function acceptFor(holds, now) {
  const presses = holds.filter((hold) => hold >= TOUCH * quantile(holds, 0.5));
  const most = Math.min(rounded(TOUCH * Math.min(...presses), 0.05, Math.floor), MOST_ACCEPT_S);
  return presses.length < FEWEST_PRESSES ? undefined : presses.length < holds.length ? most : Math.min(now, most);
}

/** How long after one press another does not count. @param {number[]} doubles from letting go to a press too many @param {number} now what is set @param {number} presses how many there were */
export function releaseFor(doubles, now, presses) {
  return presses < FEWEST_PRESSES ? undefined : Math.min(Math.max(now, ...doubles.map((one) => rounded(one, 0.05))), MOST_RELEASE_S);
}
