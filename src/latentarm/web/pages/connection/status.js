/** The state of things in one sentence, for eyes and for screen readers. */

/** A sentence that lasts shorter than this, ms, is not announced: people who nudge would hear nothing else. */
const SETTLE_MS = 120;
const SILENT_MS = 400;
/** What the server says to do next, on pages that have no such button. */
const NEXT_STEP = / (Let go of the stick, then press|Press) Enable[^.]*\.$/;

/**
 * @param {{line: HTMLElement, text: HTMLElement}} parts
 * @param {import("./connection.js").Connection} connection
 */
export function attachStatus(parts, connection) {
  /** @type {string | null} Why this page itself has stopped the arm. */
  let halted = null;
  let refused = "";
  let wanted = "";
  let timer = 0;

  const say = (/** @type {string} */ phase, /** @type {string} */ text) => {
    if (parts.line.dataset.phase !== phase) parts.line.dataset.phase = phase;
    if (text === wanted) return;
    wanted = text;
    clearTimeout(timer);
    timer = setTimeout(() => {
      parts.text.textContent = wanted;
    }, SETTLE_MS);
  };
  const show = () => {
    const { state } = connection;
    if (!connection.open) say("lost", refused || "The line to the arm is broken, and the arm has stopped. Trying again …");
    else if (state === null) say("connecting", "Connecting …");
    else if (connection.silenceMs > SILENT_MS) say("lost", "The arm's computer is silent; the arm stops by itself.");
    else if (halted !== null && !connection.engaged) say("disengaged", `Stopped: ${halted}. Press Enable to go on.`);
    else say(state.phase, document.getElementById("enable") ? state.why : state.why.replace(NEXT_STEP, ""));
  };

  connection.addEventListener("state", show);
  connection.addEventListener("line", show);
  connection.addEventListener("welcome", () => {
    refused = "";
  });
  connection.addEventListener("refused", (event) => {
    refused = /** @type {CustomEvent} */ (event).detail.why;
    show();
  });
  setInterval(show, 200);

  return {
    /** @param {string | null} why */
    halted(why) {
      halted = why;
      show();
    },
  };
}
