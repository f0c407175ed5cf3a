/** One sentence about the state and what to do now, from the state alone: no other part of the page says what to do. */

import { zoneWords } from "../layout/thing_words.js";
import { say, sayName } from "../layout/words.js";
import { practiceKey } from "../practice/step_words.js";
import { whoAsks } from "./driver_lease.js";
import { enableButtonOf } from "./enable_button.js";
import { concerns, sayTo } from "./notices.js";

/** @import {Step} from "../practice/steps.js" */
/** @import {Reader} from "./notices.js" */

/** What a key of the words says. @typedef {{key: WordKey, parameters?: Record<string, string | number>}} Words */

/**
 * @typedef {object} PageState
 * @property {Pick<Values, "panel" | "press" | "switchMotion">} values the person's settings
 * @property {HaltReason | null} halted why this page itself stopped the arm
 * @property {string} turnedAway why the server refused the page
 * @property {boolean} canEnable whether it has a button that enables
 * @property {boolean} canConnect whether it has a button that connects a lost arm again
 * @property {boolean} unconfirmed whether there are points to confirm before Enable does anything
 * @property {boolean} dialog whether a dialog is open, behind which nothing moves
 * @property {boolean} refused whether a press did nothing a moment ago
 * @property {boolean} pushAgain whether a push is about to end, or has ended, and a new one is asked for
 * @property {boolean} pressed whether a direction is pressed
 * @property {boolean} keys whether keys are at hand
 * @property {Step | null} practice the step of the practice
 * @property {Words | null} next what brings the task on
 * @property {Reader["late"]} late what was too slow, where an input of this page came late
 * @property {boolean} absent whether the arm was stopped for this reason before the page was there
 */

/** @typedef {Pick<Connection, "open" | "state" | "silenceMs" | "engaged" | "drove" | "own" | "welcome">} Heard */

const SILENT_MS = 400;
/** So often is said how long the arm stays enabled without an input, s: screen readers announce it each time. */
const IDLE_STEP_S = 5;

/**
 * The sentence, and the phase that gives it its colour.
 *
 * @param {Heard} heard
 * @param {PageState} page
 * @returns {Words & {phase: string, also?: WordKey}} `also`: a second sentence
 */
export function sentenceOf(heard, page) {
  const { open, state, silenceMs, drove } = heard;
  if (page.turnedAway && state === null) return { phase: "lost", ...only(page.turnedAway) };
  if (!open) return { phase: "lost", key: drove === null ? "status.unreached" : drove ? "status.lost" : "status.lost_watching" };
  if (state === null) return { phase: "connecting", key: "status.connecting" };
  if (silenceMs > SILENT_MS) return { phase: "lost", key: state.you ? "status.silent" : "status.silent_watching" };
  return { phase: state.phase, ...(state.you ? driverWords : watcherWords)(state, heard, page) };
}

/** @param {Words & {also?: WordKey}} sentence */
export function textOf({ key, parameters, also }) {
  return `${say(key, parameters)} ${also ? say(also) : ""}`.trim();
}

/** @param {string} reason @returns {Words} */
function only(reason) {
  return { key: "status.only", parameters: { reason } };
}

/** @param {Notice | null} notice @param {State} state @param {Heard} heard @param {PageState} page */
function told(notice, { you }, { own }, { late, absent }) {
  return notice === null ? "" : sayTo(notice, { you, own, late, absent });
}

/** Why it is slower than asked. @param {State} state */
function causeOf({ held_back, zone }) {
  return held_back && say(`held_back.${held_back}`, { zone: zoneWords(zone ?? "") });
}

/** @param {State} state @param {Heard} heard @param {PageState} page @returns {Words & {also?: WordKey}} */
function driverWords(state, heard, page) {
  const { phase, note, reason, returning, bound_for, guiding } = state;
  if (guiding === "on") return { key: "status.guided" };
  if (concerns(note, true)) return only(sayTo(note, { you: true, own: heard.own, late: page.late, absent: false }));
  if (phase === "stopping") return { key: "status.stopping", parameters: { reason: told(reason, state, heard, page) } };
  if (phase !== "ready" && phase !== "moving") return disabledWords(state, heard, page);
  if (page.dialog) return { key: "status.dialog_open", parameters: { reason: "" } };
  if (!returning) return enabledWords(state, heard, page);
  const cause = causeOf(state);
  if (bound_for === null) return cause === null ? { key: "status.returning" } : { key: "status.returning_held_back", parameters: { cause } };
  return cause === null ? { key: "status.to_pose", parameters: { pose: bound_for } } : { key: "status.to_pose_held_back", parameters: { pose: bound_for, cause } };
}

/** @param {State} state @param {Heard} heard @param {PageState} page @returns {Words & {also?: WordKey}} */
function enabledWords(state, { welcome }, { values, pushAgain, practice, pressed, keys, next }) {
  const { phase, copilot, let_go_first, idle_left_s } = state;
  const cause = causeOf(state);
  const switches = values.panel === "switch";
  const seconds = IDLE_STEP_S * Math.ceil((idle_left_s ?? 0) / IDLE_STEP_S);
  const orDisabled = (/** @type {Words} */ { key, parameters }) =>
    idle_left_s === null ? { key, parameters } : { key: /** @type {const} */ ("status.idle_soon"), parameters: { text: say(key, parameters), seconds } };
  if (welcome?.real?.shadow) return orDisabled({ key: "status.shadow_push" });
  if (phase === "moving" && cause !== null) return { key: "status.held_back", parameters: { cause } };
  if (phase === "ready" && copilot?.pace === 0) return orDisabled({ key: "status.copilot_holds", parameters: { name: sayName(copilot.name) } });
  if (pushAgain) return { key: "status.push_again" };
  if (phase === "ready" && let_go_first) return orDisabled({ key: "status.let_go" });
  if (phase === "ready" && idle_left_s !== null) return switches ? orDisabled({ key: "status.ready_switch" }) : { key: "status.idle", parameters: { seconds } };
  const lesson = practiceKey(practice, phase, pressed, values, Boolean(welcome?.goals.length));
  if (lesson !== null) return { key: lesson, also: keys ? KEYS[lesson] : undefined };
  if (phase === "moving") return { key: "status.moving" };
  return practice === null && next !== null ? next : { key: switches ? "status.ready_switch" : "status.ready" };
}

/** What is said of keys, where there are any. @type {Partial<Record<WordKey, WordKey>>} */
const KEYS = { "practice.press_stick": "keys.arrows", "practice.stop": "keys.stop" };

/** What enables the arm, and why it is not. @param {State} state @param {Heard} heard @param {PageState} page @returns {Words} */
function disabledWords(state, heard, page) {
  const { you, phase, reason: why, lost, task } = state;
  const { halted, refused, canEnable, canConnect, unconfirmed, dialog, values } = page;
  const cause = told(why, state, heard, page);
  if (lost) return canConnect ? { key: "status.not_connected", parameters: { reason: cause } } : only(cause);
  const parameters = { reason: you && halted !== null ? say(`halted.${halted}`) : refused ? say("halted.not_enabled") : cause };
  if (why?.code === "arm_emergency_stop") return only(cause);
  if (!canEnable || enableButtonOf(heard).does !== "enable") return only(parameters.reason);
  if (dialog) return { key: "status.dialog_open", parameters };
  if (unconfirmed) return { key: "status.unconfirmed", parameters };
  if (you && phase === "neutral_needed") return { key: "status.neutral_needed", parameters };
  if (you && !refused && (task.outcome !== null || task.short)) return { key: "status.task_over", parameters };
  if (values.panel === "switch") return { key: "status.disengaged_switch", parameters };
  return { key: you ? "status.disengaged" : "status.disengaged_nobody", parameters };
}

/** @param {State} state @param {Heard} heard @param {PageState} page @returns {Words} */
function watcherWords(state, heard, page) {
  const { phase, note, reason, returning, bound_for, driver, driver_name, asking_name, guiding } = state;
  const asks = whoAsks(state, heard.welcome?.id);
  const name = driver_name === null ? say("driver.somebody_else") : sayName(driver_name);
  if (page.refused && driver !== null && asks !== "you") {
    if (asks === null) return { key: "status.watching_first" };
    return { key: "status.asked_already", parameters: { name, asking: asking_name === null ? say("driver.somebody") : sayName(asking_name) } };
  }
  if (concerns(note, false)) return only(sayTo(note, { you: false, own: heard.own, late: page.late, absent: false }));
  const parameters = { name, reason: told(reason, state, heard, page) };
  const cause = causeOf(state);
  if (guiding === "on") return { key: "status.guided_watching", parameters };
  if (returning) return bound_for === null ? { key: "status.returning_watching" } : { key: "status.to_pose_watching", parameters: { pose: bound_for } };
  switch (phase) {
    case "ready": return { key: "status.ready_watching", parameters };
    case "moving": return cause === null ? { key: "status.moving_watching", parameters } : { key: "status.held_back_watching", parameters: { name, cause } };
    case "stopping": return { key: "status.stopping", parameters };
    default: return driver === null ? disabledWords(state, heard, page) : { key: asks === "you" ? "status.asked" : "status.watching", parameters };
  }
}
