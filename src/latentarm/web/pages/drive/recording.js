/** Recording what is driven into a dataset, one episode at a time. */

/** Samples a second: the control loop's rate. */
const RATE_HZ = 100;

/**
 * @param {{button: HTMLButtonElement, task: HTMLInputElement, text: HTMLElement, teach: HTMLElement}} parts
 * @param {import("../connection/connection.js").Connection} connection
 */
export function attachRecording(parts, connection) {
  parts.button.addEventListener("click", () => {
    const on = !connection.state?.recording?.on;
    const task = parts.task.value.trim();
    connection.send("record", on && task ? { on, task } : { on });
  });
  connection.addEventListener("state", () => {
    const { recording, you } = connection.state;
    const on = Boolean(recording?.on);
    parts.button.disabled = !you;
    parts.button.setAttribute("aria-pressed", String(on));
    write(parts.button, on ? "Stop recording" : "Start recording");
    const episodes = recording?.episodes ?? 0;
    const kept = episodes === 0 ? "Nothing recorded yet." : `${episodes} ${episodes === 1 ? "episode" : "episodes"} recorded.`;
    parts.teach.hidden = on || episodes === 0;
    if (recording?.problem) write(parts.text, recording.problem);
    else write(parts.text, on ? `Recording episode ${episodes + 1}: ${Math.floor(recording.samples / RATE_HZ)} s.` : you ? kept : "The person who drives can record.");
  });
}

/** @param {HTMLElement} element @param {string} text */
function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
