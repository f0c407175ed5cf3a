/** Recording what is driven into a dataset, one episode at a time. */

import { setHidden, setText } from "../layout/dom.js";
import { say, sayNotice } from "../layout/words.js";

/** @import {Connection} from "../connection/connection.js" */
/** @import {State} from "../connection/messages.js" */

/** Samples a second: the control loop's rate. */
const RATE_HZ = 100;

/** How the recording stands, in words. @param {Pick<State, "recording" | "you" | "phase" | "guiding">} state */
export function recordingWords({ recording, you, phase, guiding }) {
  if (recording?.problem) return sayNotice(recording.problem);
  const episodes = recording?.episodes ?? 0;
  // An arm with a mode of its own for guiding by hand moves without being enabled.
  const still = (phase === "disengaged" || phase === "neutral_needed") && (guiding === null || guiding === "offered");
  if (recording?.on) return say(still ? "recording.waiting" : "recording.on", { episode: episodes + 1, seconds: Math.floor(recording.samples / RATE_HZ) });
  if (!you) return say("recording.not_you");
  return episodes ? say("recording.kept", { count: episodes }) : say("recording.none");
}

/**
 * The page Teach links to the section by its id: its dialog opens there.
 * @param {{section: HTMLElement, button: HTMLButtonElement, end: HTMLElement, task: HTMLInputElement, text: HTMLElement, teach: HTMLElement}} parts
 * @param {Connection} connection
 */
export function attachRecording(parts, connection) {
  const press = () => {
    const on = !connection.state?.recording?.on;
    const task = parts.task.value.trim();
    connection.send(on && task ? { type: "record", on, task } : { type: "record", on });
  };
  for (const button of [parts.button, parts.end]) button.addEventListener("click", press);
  if (location.hash === `#${parts.section.id}`) connection.addEventListener("state", () => {
    parts.section.closest("dialog")?.showModal();
    parts.section.focus({ preventScroll: true });
    parts.section.scrollIntoView({ block: "center" });
  }, { once: true });
  connection.addEventListener("state", () => {
    const { state } = connection;
    if (!state) return;
    const on = Boolean(state.recording?.on);
    parts.button.disabled = !state.you;
    parts.button.setAttribute("aria-pressed", String(on));
    setText(parts.button, say(on ? "recording.stop" : "recording.start"));
    setHidden(parts.end, !(on && state.you));
    setHidden(parts.teach, on || !state.recording?.episodes);
    setText(parts.text, recordingWords(state));
  });
}
