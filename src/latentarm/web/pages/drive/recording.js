/** Recording what is driven into a dataset, one episode at a time. */

import { byId, setHidden, setText } from "../layout/dom.js";
import { say, sayNotice } from "../layout/words.js";

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

/** The page Teach links to the section by its id: its dialog opens there. @param {Connection} connection */
export function attachRecording(connection) {
  const [section, button, end] = [byId("recording"), byId("record", HTMLButtonElement), byId("record-end")];
  const press = () => {
    const on = !connection.state?.recording?.on;
    const task = byId("record-task", HTMLInputElement).value.trim();
    connection.send(on && task ? { type: "record", on, task } : { type: "record", on });
  };
  for (const one of [button, end]) one.addEventListener("click", press);
  if (location.hash === `#${section.id}`) connection.addEventListener("state", () => {
    section.closest("dialog")?.showModal();
    section.focus({ preventScroll: true });
    section.scrollIntoView({ block: "center" });
  }, { once: true });
  connection.addEventListener("state", () => {
    const { state } = connection;
    if (!state) return;
    const on = Boolean(state.recording?.on);
    button.disabled = !state.you;
    button.setAttribute("aria-pressed", String(on));
    setText(button, say(on ? "recording.stop" : "recording.start"));
    setHidden(end, !(on && state.you));
    setHidden(byId("record-teach"), on || !state.recording?.episodes);
    setText(byId("record-text"), recordingWords(state));
  });
}
