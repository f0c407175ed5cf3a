/** Every figure about drives, defined once: what it is called, what it means, how it is counted and said. */

import { say, sayNumber, sayPercent } from "../layout/words.js";
import { inputWords, timeWords } from "./drive_words.js";

/** @import {WordKey} from "../layout/words.js" */
/** @import {Drive} from "./weeks.js" */

/** Said where there is nothing to count. */
export const NONE = "–";

/** Figures that are numbers, each null where no drive has it. */
const COUNTED = {
  /** Seconds. @param {Drive[]} drives */
  driven: (drives) => sum(drives.map(({ time_s }) => time_s)),
  /** Of all drives whose end the page can see. @param {Drive[]} drives */
  success: (drives) => mean(drives.filter(isWatched).map((drive) => Number(isDone(drive)))),
  /** Seconds. @param {Drive[]} drives */
  time: (drives) => median(drives.filter(isDone).map(({ time_s }) => time_s)),
  /** @param {Drive[]} drives */
  stops_person: (drives) => mean(drives.map(({ stops_by }) => stops_by.person)),
  /** @param {Drive[]} drives */
  stops_page: (drives) => mean(drives.map(({ stops_by }) => stops_by.page)),
  /** @param {Drive[]} drives */
  stops_arm: (drives) => mean(drives.map(({ stops_by }) => stops_by.arm)),
  /** @param {Drive[]} drives */
  presses: (drives) => mean(drives.map(({ presses }) => presses)),
};

/** @typedef {keyof typeof COUNTED} Counted */

/** What each figure is called and means. @type {Record<"drives" | Counted | "input", {title: WordKey, means: WordKey}>} */
export const FIGURES = {
  drives: { title: "report.drives", means: "report.drives_means" },
  driven: { title: "report.driven", means: "report.driven_means" },
  success: { title: "report.success", means: "report.success_means" },
  time: { title: "report.time", means: "report.time_means" },
  stops_person: { title: "report.stops_person", means: "report.stops_person_means" },
  stops_page: { title: "report.stops_page", means: "report.stops_page_means" },
  stops_arm: { title: "report.stops_arm", means: "report.stops_arm_means" },
  presses: { title: "report.presses", means: "report.presses_means" },
  input: { title: "report.input", means: "report.input_means" },
};

/** @typedef {keyof typeof FIGURES} Figure */

/** @param {Counted} figure @param {Drive[]} drives @returns {number | null} */
export function count(figure, drives) {
  return COUNTED[figure](drives);
}

/** A figure in words. @param {Figure} figure @param {Drive[]} drives */
export function figureOf(figure, drives) {
  if (figure === "drives") return String(drives.length);
  if (figure === "input") return inputFigure(drives);
  const value = count(figure, drives);
  if (value === null) return NONE;
  if (figure === "success") {
    return say("report.share_of", { share: sayPercent(value), part: drives.filter(isDone).length, all: drives.filter(isWatched).length });
  }
  return figure === "driven" || figure === "time" ? timeWords(value) : sayNumber(value, 1);
}

/** How long each input was pushed, the longest first, and for how many drives that is not known. @param {Drive[]} drives */
export function inputTimes(drives) {
  /** @type {Record<string, number>} */
  const times = {};
  for (const drive of drives) {
    for (const [input, time_s] of Object.entries(drive.input_s ?? {})) times[input] = (times[input] ?? 0) + time_s;
  }
  const unknown = drives.filter(({ input_s }) => input_s === null).length;
  return { times: Object.entries(times).sort(([, one], [, other]) => other - one), unknown };
}

/** @param {Drive[]} drives */
function inputFigure(drives) {
  const { times, unknown } = inputTimes(drives);
  const all = sum(times.map(([, time_s]) => time_s));
  const most = all ? [say("report.input_most", { input: inputWords(times[0][0]), share: sayPercent(times[0][1] / all) })] : [];
  const missing = unknown ? [say("report.not_known", { count: unknown })] : [];
  return [...most, ...missing].join("; ") || NONE;
}

/** @param {Drive} drive */
function isDone({ outcome }) {
  return outcome === "success";
}

/** Whether the page can see how a drive ends. @param {Drive} drive */
export function isWatched({ steps, outcome }) {
  return steps !== null || outcome !== null;
}

/** @param {number[]} values @returns {number | null} null without values */
export function median(values) {
  const sorted = [...values].sort((one, other) => one - other);
  const middle = sorted.length >> 1;
  if (!sorted.length) return null;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/** @param {number[]} values @returns {number | null} null without values */
function mean(values) {
  return values.length ? sum(values) / values.length : null;
}

/** @param {number[]} values */
function sum(values) {
  return values.reduce((total, value) => total + value, 0);
}
