/** Every figure about drives, defined once. It is called `report.<figure>`, and `report.<figure>_means` says what it counts. */

import { say, sayNumber, sayPercent } from "../layout/words.js";
import { inputWords, timeWords } from "./drive_words.js";

/** Numbers; null where no drive has one. @type {Record<Counted, (drives: Drive[]) => number | null>} */
export const COUNTED = {
  driven: (drives) => sum(drives.map(({ time_s }) => time_s)),
  success: (drives) => mean(drives.filter(isWatched).map((drive) => Number(isDone(drive)))),
  time: (drives) => median(drives.filter(isDone).map(({ time_s }) => time_s)),
  stops_person: (drives) => mean(drives.map(({ stops_by }) => stops_by.person)),
  stops_page: (drives) => mean(drives.map(({ stops_by }) => stops_by.page)),
  stops_arm: (drives) => mean(drives.map(({ stops_by }) => stops_by.arm)),
  presses: (drives) => mean(drives.map(({ presses }) => presses)),
};

/** @typedef {"driven" | "success" | "time" | "stops_person" | "stops_page" | "stops_arm" | "presses"} Counted */
/** @typedef {Counted | "drives" | "input"} Figure */

/** @type {Figure[]} */
export const FIGURES = ["drives", "driven", "success", "time", "stops_person", "stops_page", "stops_arm", "presses", "input"];

/** A figure in words. @param {Figure} figure @param {Drive[]} drives */
export function figureOf(figure, drives) {
  if (figure === "drives") return String(drives.length);
  if (figure === "input") return inputMost(drives);
  const value = COUNTED[figure](drives);
  if (value === null) return "–";
  if (figure !== "success") return figure === "driven" || figure === "time" ? timeWords(value) : sayNumber(value, 1);
  return say("report.share_of", { share: sayPercent(value), part: drives.filter(isDone).length, all: drives.filter(isWatched).length });
}

/** The input that was pushed longest, and for how many drives that is not known. @param {Drive[]} drives */
function inputMost(drives) {
  /** @type {Record<string, number>} */
  const times = {};
  for (const [input, time_s] of drives.flatMap(({ input_s }) => Object.entries(input_s ?? {}))) times[input] = (times[input] ?? 0) + time_s;
  const [most] = Object.entries(times).sort(([, one], [, other]) => other - one);
  const unknown = drives.filter(({ input_s }) => input_s === null).length;
  return [
    most && say("report.input_most", { input: inputWords(most[0]), share: sayPercent(most[1] / (sum(Object.values(times)) || 1)) }),
    unknown && say("report.not_known", { count: unknown }),
  ].filter(Boolean).join("; ") || "–";
}

/** @param {Drive} drive */
function isDone({ outcome }) {
  return outcome === "success";
}

/** True if the page can see how a drive ends. @param {Drive} drive */
function isWatched({ steps, outcome }) {
  return steps !== null || outcome !== null;
}

/** @param {number[]} values @returns {number | null} null without values */
function median(values) {
  const sorted = [...values].sort((one, other) => one - other);
  const middle = sorted.length >> 1;
  return mean(sorted.length % 2 ? [sorted[middle]] : sorted.slice(Math.max(middle - 1, 0), middle + 1));
}

/** @param {number[]} values @returns {number | null} null without values */
function mean(values) {
  return values.length ? sum(values) / values.length : null;
}

/** @param {number[]} values */
function sum(values) {
  return values.reduce((total, value) => total + value, 0);
}
