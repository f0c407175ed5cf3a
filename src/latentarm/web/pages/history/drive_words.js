/** A drive in words. */

import { taskTitle, thingWords } from "../layout/thing_words.js";
import { say, sayNumber } from "../layout/words.js";

/** @type {Record<string, WordKey>} */
const INPUTS = {
  pointer: "history.input_pointer", keyboard: "history.input_keyboard", dpad: "history.input_dpad",
  gamepad: "history.input_gamepad", switch: "history.input_switch",
};

/** @param {string} input */
export function inputWords(input) {
  return INPUTS[input] ? say(INPUTS[input]) : input;
}

/** @param {Pick<Drive, "task" | "choice">} drive */
export function taskWords({ task, choice }) {
  return choice ? say("history.task_choice", { task: taskTitle(task), choice: thingWords(choice) }) : taskTitle(task);
}

/** @param {Drive} drive */
export function outcomeWords({ outcome, ended, steps }) {
  if (outcome !== null) return say(outcome === "success" ? "history.done" : "history.failed");
  if (ended === "broken_off") return say("history.broken_off");
  return say(steps === null ? "history.open" : "history.given_up");
}

/** Who stopped the arm, and how often. @param {Drive} drive */
export function stoppedBy({ stops_by }) {
  const who = /** @type {("person" | "page" | "arm")[]} */ (["person", "page", "arm"]).filter((one) => stops_by[one]);
  return who.map((one) => say(`history.stops_${one}`, { count: stops_by[one] })).join(", ") || say("history.no_stops");
}

/** @param {number} seconds */
export function timeWords(seconds) {
  if (seconds < 60) return say("unit.seconds", { value: sayNumber(seconds, seconds < 10 ? 1 : 0) });
  return say("history.minutes", { minutes: Math.floor(seconds / 60), seconds: Math.round(seconds % 60) });
}

/** Each figure stays on one line. @param {Drive} drive */
export function figureWords(drive) {
  const steps = drive.steps === null ? "" : say("history.steps", { done: drive.steps_done ?? 0, all: drive.steps });
  return [
    drive.inputs.map(inputWords).join(", "),
    timeWords(drive.time_s),
    say("history.idle", { time: timeWords(drive.time_s - drive.moving_s) }),
    stoppedBy(drive),
    say("history.presses", { count: drive.presses }),
    steps,
  ].filter(Boolean).map((text) => text.replaceAll(" ", "\u00a0")).join(" · ");
}
