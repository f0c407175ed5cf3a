/** Guiding a real arm by hand: begun and ended here, recorded meanwhile, and the gripper moved by two buttons. */

import { recordingWords } from "../drive/recording.js";
import { byId, setDisabled, setHidden, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** The server ends guiding where it does not hear from this page for five times as long, ms. */
const PERIOD_MS = 200;
/** The arm takes no longer to begin, ms. */
const BEGINS_MS = 6000;

/**
 * The button's action now, the text next to it, and whether a motion by hand can be recorded. @param {State | null} state
 * @param {{waiting: boolean, confirmed: boolean}} page @returns {{does: "begin" | "end" | null, why: WordKey, records: boolean}}
 */
export function guidingOf(state, { waiting, confirmed }) {
  if (state === null || (state.driver !== null && !state.you)) return { does: null, why: "guiding.driver_only", records: false };
  if (state.guiding === "on") return { does: "end", why: "guiding.on", records: true };
  if (waiting) return { does: "end", why: "guiding.wait", records: false };
  if (state.phase === "moving" || state.phase === "ready" || state.phase === "stopping") return { does: null, why: "guiding.stop_first", records: false };
  const own = state.guiding === "own";
  return { does: confirmed ? "begin" : null, why: own ? "guiding.own" : "guiding.off", records: own };
}

/** Returns what a Stop does here: the page asks for nothing any more, and the server ends guiding. @param {Connection} connection @param {DriverLease} lease */
export function attachGuiding(connection, lease) {
  const [button, recorder, confirmed] = [byId("guiding-begin"), byId("guiding-record"), byId("guiding-loaded", HTMLInputElement)];
  let asked = false;
  let begun = false;
  let askedAt = -Infinity;
  const now = () => guidingOf(connection.state, { waiting: asked && !begun, confirmed: confirmed.checked });

  // A confirmation counts once: the person who held the arm may have let go.
  const over = () => {
    if (begun) confirmed.checked = false;
    asked = begun = false;
  };
  const end = () => {
    const tell = asked || connection.state?.guiding === "on";
    over();
    if (tell && connection.driving) connection.send({ type: "guide", on: false });
    show();
  };
  const begin = () => {
    asked = true;
    begun = false;
    askedAt = performance.now();
    connection.send({ type: "guide", on: true });
    show();
  };
  const press = () => {
    const { does } = now();
    if (does === "end") end();
    else if (does === "begin") lease.ask(begin);
  };
  const record = () => {
    const { state } = connection;
    const on = !state?.recording?.on;
    if (!connection.driving || (on && !now().records)) return;
    connection.send({ type: "record", on, task: byId("guiding-task", HTMLInputElement).value.trim(), by_hand: true });
  };
  const grip = (/** @type {"open" | "close"} */ gripper) => {
    if (connection.driving && connection.state?.guiding === "on") connection.send({ type: "guided", gripper });
  };
  const show = () => {
    const { state, welcome } = connection;
    if (state === null || welcome === null) return;
    const { does, why, records } = now();
    const recording = Boolean(state.recording?.on);
    setHidden(byId("guiding"), state.guiding === null);
    setText(button, say(does === "end" ? "guiding.end" : "guiding.begin"));
    setDisabled(button, does === null);
    setText(byId("guiding-why"), say(why));
    setHidden(byId("guiding-check"), does === "end");
    setHidden(byId("guiding-doing"), !(records || recording));
    setText(recorder, say(recording ? "recording.stop" : "recording.start"));
    recorder.setAttribute("aria-pressed", String(recording));
    setDisabled(recorder, !state.you);
    setText(byId("guiding-recorded"), recordingWords(state));
    setHidden(byId("guiding-gripper"), welcome.gripper_width_m === null || state.guiding !== "on");
  };
  const look = () => {
    const on = connection.state?.guiding === "on";
    // After the arm, Stop or the server has ended it, only a press asks for it again.
    if (asked && ((begun && !on) || (!begun && performance.now() - askedAt > BEGINS_MS) || connection.state?.guiding === "own")) over();
    else if (asked && on) begun = true;
    show();
  };

  button.addEventListener("click", press);
  recorder.addEventListener("click", record);
  byId("guiding-open").addEventListener("click", () => grip("open"));
  byId("guiding-close").addEventListener("click", () => grip("close"));
  confirmed.addEventListener("change", show);
  connection.addEventListener("state", look);
  connection.addEventListener("open", () => {
    over();
    show();
  });
  window.addEventListener("pagehide", end);
  document.addEventListener("visibilitychange", () => {
    if (document.hidden) end();
  });
  setInterval(() => {
    if (asked && connection.driving && !document.hidden) connection.send({ type: "guided" });
  }, PERIOD_MS);
  show();

  return () => {
    asked = begun = false;
  };
}
