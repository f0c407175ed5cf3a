/** The state of things in one sentence, for eyes and for screen readers. */

import { setText } from "../layout/dom.js";
import { say, sayNotice } from "../layout/words.js";

/** @import {HaltReason} from "../inputs/deflection.js" */
/** @import {Connection} from "./connection.js" */
/** @import {State} from "./messages.js" */

/** A sentence that lasts shorter than this, ms, is not announced: people who nudge would hear nothing else. */
const SETTLE_MS = 120;
const SILENT_MS = 400;
const LOOK_MS = 200;

/**
 * What to say, and the phase that gives it its colour.
 *
 * @param {Pick<Connection, "open" | "state" | "silenceMs" | "engaged">} connection
 * @param {{halted: HaltReason | null, refused: string, canEnable: boolean}} page why this page itself stopped the arm,
 *   why the server refused it, and whether it has a button that enables
 * @returns {{phase: string, text: string}}
 */
export function statusOf({ open, state, silenceMs, engaged }, { halted, refused, canEnable }) {
  if (!open) return { phase: "lost", text: refused || say("status.lost") };
  if (state === null) return { phase: "connecting", text: say("status.connecting") };
  if (silenceMs > SILENT_MS) return { phase: "lost", text: say("status.silent") };
  if (halted !== null && !engaged) return { phase: "disengaged", text: say(`halted.${halted}`) };
  return { phase: state.phase, text: phaseWords(state, canEnable) };
}

/**
 * What the arm does, and what to do next.
 *
 * @param {State} state
 * @param {boolean} canEnable
 */
function phaseWords({ phase, note, reason, held_back, copilot }, canEnable) {
  if (note !== null) return sayNotice(note);
  const parameters = { reason: reason === null ? "" : sayNotice(reason) };
  switch (phase) {
    case "ready": return copilot?.pace === 0 ? say("status.copilot_holds", { name: copilot.name }) : say("status.ready");
    case "moving": return held_back === null ? say("status.moving") : say("status.held_back", { cause: say(`held_back.${held_back}`) });
    case "stopping": return say("status.stopping", parameters);
    default: return canEnable ? say(`status.${phase}`, parameters) : parameters.reason;
  }
}

/**
 * @param {{line: HTMLElement, text: HTMLElement}} parts
 * @param {Connection} connection
 */
export function attachStatus(parts, connection) {
  /** @type {HaltReason | null} */
  let halted = null;
  let refused = "";
  let wanted = "";
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  const canEnable = document.getElementById("enable") !== null;

  const show = () => {
    const { phase, text } = statusOf(connection, { halted, refused, canEnable });
    if (parts.line.dataset.phase !== phase) parts.line.dataset.phase = phase;
    if (text === wanted) return;
    wanted = text;
    clearTimeout(timer);
    timer = setTimeout(() => setText(parts.text, wanted), SETTLE_MS);
  };

  connection.addEventListener("state", show);
  connection.addEventListener("open", show);
  connection.addEventListener("welcome", () => {
    refused = "";
  });
  connection.addEventListener("refused", (event) => {
    refused = sayNotice(/** @type {CustomEvent} */ (event).detail.notice);
    show();
  });
  setInterval(show, LOOK_MS);

  return {
    /** @param {HaltReason | null} why this page itself has stopped the arm */
    halted(why) {
      halted = why;
      show();
    },
  };
}
