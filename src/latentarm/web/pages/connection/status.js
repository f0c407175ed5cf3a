/** The state of things in one sentence, for eyes and for screen readers. */

import { setText } from "../layout/dom.js";
import { zoneWords } from "../layout/thing_words.js";
import { say, sayName } from "../layout/words.js";
import { whoAsks } from "./driver_lease.js";
import { concerns, sayTo } from "./notices.js";

/** @import {HaltReason} from "../inputs/deflection.js" */
/** @import {Connection} from "./connection.js" */
/** @import {State} from "./messages.js" */
/** @import {Reader} from "./notices.js" */
/** @import {WordKey} from "../layout/words.js" */

/** A sentence that lasts shorter than this, ms, is not announced: people who nudge would hear nothing else. */
const SETTLE_MS = 120;
const SILENT_MS = 400;
const LOOK_MS = 200;
/** So often is said how long the arm stays enabled without an input, s: screen readers announce it each time. */
const IDLE_STEP_S = 5;
/** How long is said why a press does nothing, ms. */
const REFUSED_MS = 4000;

/**
 * @typedef {object} PageState
 * @property {HaltReason | null} halted why this page itself stopped the arm
 * @property {string} turnedAway why the server refused the page
 * @property {boolean} canEnable whether it has a button that enables
 * @property {boolean} canConnect whether it has a button that connects a lost arm again
 * @property {boolean} unconfirmed whether there are points to confirm before Enable does anything
 * @property {WordKey | null} refused why a press did nothing a moment ago
 * @property {boolean} pushAgain whether a push is about to end, or has ended, and a new one is asked for
 * @property {Reader["late"]} late what was too slow, where an input of this page came late
 */

/** @typedef {Pick<Connection, "open" | "state" | "silenceMs" | "engaged" | "drove" | "own" | "welcome">} Heard */

/** Reasons for which somebody must look at the arm, or at the computer that drives it. */
const TROUBLE = ["arm_emergency_stop", "arm_fault", "arm_lost", "arm_off", "arm_process_ended", "arm_process_silent"];

/** Whether the arm is stopped for such a reason. @param {Pick<State, "phase" | "note" | "reason"> | null} state */
export function isTrouble(state) {
  return state?.phase === "disengaged" && [state.note, state.reason].some((why) => why && TROUBLE.includes(why.code));
}

/**
 * The sentence to show, and the phase that gives it its colour.
 *
 * @param {Heard} connection
 * @param {PageState} page
 * @returns {{phase: string, text: string}}
 */
export function statusOf({ open, state, silenceMs, engaged, drove, own, welcome }, page) {
  const { halted, turnedAway, refused, late } = page;
  if (turnedAway && state === null) return { phase: "lost", text: turnedAway };
  if (!open) return { phase: "lost", text: say(drove === null ? "status.unreached" : drove ? "status.lost" : "status.lost_watching") };
  if (state === null) return { phase: "connecting", text: say("status.connecting") };
  const { you } = state;
  if (silenceMs > SILENT_MS) return { phase: "lost", text: say(you ? "status.silent" : "status.silent_watching") };
  if (refused && !you && state.driver !== null) return { phase: state.phase, text: say("status.watching_first") };
  if (refused && !engaged) return { phase: "disengaged", text: say(refused) };
  if (halted !== null && you && !engaged) return { phase: "disengaged", text: say(`halted.${halted}`) };
  const reader = { you, own, late };
  const text = you ? driverWords(state, page, reader) : watcherWords(state, page, whoAsks(state, welcome?.id) === "you", reader);
  return { phase: state.phase, text };
}

/**
 * The arm's state, and the driver's next action.
 *
 * @param {State} state
 * @param {PageState} page
 * @param {Reader} reader
 */
function driverWords({ phase, note, reason, held_back, zone, returning, bound_for, let_go_first, copilot, guiding, lost, idle_left_s }, { canEnable, canConnect, unconfirmed, pushAgain }, reader) {
  if (guiding === "on") return say("status.guided");
  if (concerns(note, true)) return sayTo(note, reader);
  const parameters = { reason: reason === null ? "" : sayTo(reason, reader) };
  const cause = held_back && say(`held_back.${held_back}`, { zone: zoneWords(zone ?? "") });
  if (returning && bound_for !== null) {
    return cause === null ? say("status.to_pose", { pose: bound_for }) : say("status.to_pose_held_back", { pose: bound_for, cause });
  }
  if (returning) return cause === null ? say("status.returning") : say("status.returning_held_back", { cause });
  if (pushAgain && (phase === "ready" || phase === "moving")) return say("status.push_again");
  switch (phase) {
    case "ready":
      if (idle_left_s !== null) return say("status.idle", { seconds: IDLE_STEP_S * Math.ceil(idle_left_s / IDLE_STEP_S) });
      if (copilot?.pace === 0) return say("status.copilot_holds", { name: sayName(copilot.name) });
      return say(let_go_first ? "status.let_go" : "status.ready");
    case "moving": return cause === null ? say("status.moving") : say("status.held_back", { cause });
    case "stopping": return say("status.stopping", parameters);
    default:
      if (lost) return canConnect ? say("status.not_connected", parameters) : parameters.reason;
      return canEnable ? say(unconfirmed ? "status.unconfirmed" : `status.${phase}`, parameters) : parameters.reason;
  }
}

/**
 * The arm's state, for those who do not drive it.
 *
 * @param {State} state
 * @param {PageState} page
 * @param {boolean} asked whether this page has asked to drive
 * @param {Reader} reader
 */
function watcherWords({ phase, note, reason, held_back, zone, returning, bound_for, driver, driver_name, guiding, lost }, { canEnable, canConnect, unconfirmed }, asked, reader) {
  if (concerns(note, false)) return sayTo(note, reader);
  const name = driver_name === null ? say("driver.somebody_else") : sayName(driver_name);
  if (guiding === "on") return say("status.guided_watching", { name });
  const parameters = { name, reason: reason === null ? "" : sayTo(reason, reader) };
  if (returning) return bound_for === null ? say("status.returning_watching") : say("status.to_pose_watching", { pose: bound_for });
  switch (phase) {
    case "ready": return say("status.ready_watching", parameters);
    case "moving": return held_back === null
      ? say("status.moving_watching", parameters)
      : say("status.held_back_watching", { name, cause: say(`held_back.${held_back}`, { zone: zoneWords(zone ?? "") }) });
    case "stopping": return say("status.stopping", parameters);
    default:
  }
  if (driver === null) {
    if (lost && canConnect) return say("status.not_connected", parameters);
    if (!canEnable || lost) return parameters.reason;
    return say(unconfirmed ? "status.unconfirmed" : "status.disengaged_nobody", parameters);
  }
  return say(asked ? "status.asked" : "status.watching", parameters);
}

/**
 * @param {{line: HTMLElement, text: HTMLElement}} parts
 * @param {Connection} connection
 */
export function attachStatus(parts, connection) {
  /** @type {HaltReason | null} */
  let halted = null;
  let turnedAway = "";
  let wanted = "";
  let pushAgain = false;
  let refusedUntil = -Infinity;
  /** @type {WordKey} */
  let why = "halted.not_enabled";
  let wasLate = false;
  /** @type {Reader["late"]} */
  let late = "connection";
  /** Whether this page has heard of the arm before. */
  let heard = false;
  /** Whether this page itself was too slow a moment ago. */
  let slow = () => false;
  /** Whether there are points to confirm before Enable does anything. */
  let unconfirmed = () => false;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  const canEnable = document.getElementById("enable") !== null;
  const canConnect = document.getElementById("lost") !== null;

  const show = () => {
    const { state } = connection;
    const isLate = state?.reason?.code === "input_late";
    // Late inputs while this page did not drive were somebody else's.
    if (isLate && !wasLate) late = !(heard && state?.you) ? null : slow() ? "page" : "connection";
    wasLate = isLate;
    heard = state !== null;
    // This page's actions no longer count once somebody else drives.
    if (state !== null && !state.you) halted = null;
    const refused = performance.now() < refusedUntil ? why : null;
    const { phase, text } = statusOf(connection, { halted, turnedAway, canEnable, canConnect, unconfirmed: unconfirmed(), refused, pushAgain, late });
    parts.line.toggleAttribute("data-trouble", isTrouble(state));
    if (parts.line.dataset.phase !== phase) parts.line.dataset.phase = phase;
    if (text === wanted) return;
    wanted = text;
    clearTimeout(timer);
    timer = setTimeout(() => setText(parts.text, wanted), SETTLE_MS);
  };

  connection.addEventListener("state", show);
  connection.addEventListener("open", show);
  connection.addEventListener("welcome", () => {
    turnedAway = "";
  });
  connection.addEventListener("refused", (event) => {
    turnedAway = sayTo(/** @type {CustomEvent} */ (event).detail.notice, { you: false, own: connection.own, late });
    show();
  });
  setInterval(show, LOOK_MS);

  return {
    /** @param {HaltReason | null} why this page itself has stopped the arm */
    halted(why) {
      halted = why;
      refusedUntil = -Infinity;
      show();
    },
    /** A press cannot move the arm now. @param {WordKey} because what is said of it */
    refused(because = "halted.not_enabled") {
      why = because;
      refusedUntil = performance.now() + REFUSED_MS;
      show();
    },
    /** @param {boolean} is whether a push is about to end, or has ended, and a new one is asked for */
    asksToPushAgain(is) {
      pushAgain = is;
      show();
    },
    /** The reason why a press was refused no longer holds. */
    allowed() {
      refusedUntil = -Infinity;
      show();
    },
    /** @param {() => boolean} isSlow whether this page itself was too slow a moment ago */
    watch(isSlow) {
      slow = isSlow;
    },
    /** @param {() => boolean} isUnconfirmed whether there are points to confirm before Enable does anything */
    ask(isUnconfirmed) {
      unconfirmed = isUnconfirmed;
      show();
    },
  };
}
