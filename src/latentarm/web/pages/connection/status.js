/** The state of things in one sentence, for eyes and for screen readers. */

import { attachSpeech } from "../inputs/speech.js";
import { setText } from "../layout/dom.js";
import { sayTo } from "./notices.js";
import { sentenceOf, textOf } from "./sentence.js";

/** @import {Reader} from "./notices.js" */
/** @import {PageState} from "./sentence.js" */

/** A sentence that lasts shorter than this, ms, is not announced: people who nudge would hear nothing else. */
const SETTLE_MS = 120;
const LOOK_MS = 200;
/** What lasts shorter than this, ms, is not spoken. */
const SPOKEN_MS = 1000;
/** A sentence with more letters takes the room of the legend on a phone. */
const LONG = 90;
/** How long is said why a press does nothing, ms. */
const REFUSED_MS = 4000;

/** What a page without a control knows. @type {Pick<PageState, "unconfirmed" | "dialog" | "pressed" | "keys" | "practice" | "next"> & {slow: boolean}} */
const NO_CONTROL = { unconfirmed: false, dialog: false, pressed: false, keys: false, practice: null, next: null, slow: false };

/** Reasons for which somebody must look at the arm, or at the computer that drives it. */
const TROUBLE = ["arm_emergency_stop", "arm_fault", "arm_lost", "arm_off", "arm_process_ended", "arm_process_silent"];

/** Whether the arm is stopped for such a reason. @param {Pick<State, "phase" | "note" | "reason"> | null} state */
export function isTrouble(state) {
  return state?.phase === "disengaged" && [state.note, state.reason].some((why) => why && TROUBLE.includes(why.code));
}

/** @param {{line: HTMLElement, text: HTMLElement}} parts @param {Connection} connection @param {Pick<Settings, "values">} settings */
export function attachStatus(parts, connection, settings) {
  /** @type {HaltReason | null} */
  let halted = null;
  let turnedAway = "";
  let wanted = "";
  let pushAgain = false;
  let refusedUntil = -Infinity;
  let wasLate = false;
  /** @type {Reader["late"]} */
  let late = "connection";
  /** Why the arm was stopped when this page found it, until anything else has been seen. @type {string | null} */
  let found = null;
  let look = () => NO_CONTROL;
  const speak = attachSpeech(settings, "speakNext", SPOKEN_MS);
  let timer = 0;
  const canEnable = document.getElementById("enable") !== null;
  const canConnect = document.getElementById("lost") !== null;

  const show = () => {
    const { state } = connection;
    const { slow, ...control } = look();
    const isLate = state?.reason?.code === "input_late";
    // Late inputs while this page did not drive were somebody else's.
    if (isLate && !wasLate) late = !(found !== null && state?.you) ? null : slow ? "page" : "connection";
    wasLate = isLate;
    // This page's actions no longer count once somebody else drives.
    if (state !== null && !state.you) halted = null;
    const why = JSON.stringify(state?.reason ?? null);
    if (state !== null) found = found === null || found === why ? why : "";
    const sentence = sentenceOf(connection, {
      ...control, values: settings.values, halted, turnedAway, canEnable, canConnect, refused: performance.now() < refusedUntil, pushAgain, late, absent: found === why,
    });
    const [{ phase }, text] = [sentence, textOf(sentence)];
    parts.line.toggleAttribute("data-trouble", isTrouble(state));
    parts.line.toggleAttribute("data-long", text.length > LONG);
    if (parts.line.dataset.phase !== phase) parts.line.dataset.phase = phase;
    // While the arm moves there is nothing to be done but to look.
    if (!document.hidden) speak(phase === "moving" ? "" : text);
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
    turnedAway = sayTo(/** @type {CustomEvent} */ (event).detail.notice, { you: false, own: connection.own, late, absent: false });
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
    /** A press cannot move the arm now. */
    refused() {
      refusedUntil = performance.now() + REFUSED_MS;
      show();
    },
    /** @param {boolean} is whether a push is about to end, or has ended, and a new one is asked for */
    asksToPushAgain(is) {
      pushAgain = is;
      show();
    },
    /** @param {() => typeof NO_CONTROL} atControl what the page with the control knows now, and whether it was too slow a moment ago */
    watch(atControl) {
      look = atControl;
      show();
    },
  };
}
