/** The replay of one drive in the two views of the Drive page. */

import { byId, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { ask } from "../records/ask.js";
import { attachViews } from "../views/attach_views.js";
import { timeWords } from "./drive_words.js";
import { NOTHING_PREDICTED } from "../views/predictions.js";
import { Player } from "./player.js";

/** @import {Moment} from "./player.js" */

/** @param {Settings} settings */
export function attachReplay(settings) {
  /** @type {Drawing | null} */
  let drawing = null;
  /** @type {Player | null} */
  let player = null;
  /** The scene that is drawn: another one needs the page anew. */
  let scene = "";
  let tick = 0;
  /** @type {Moment | null} */
  let newest = null;
  const seek = byId("seek", HTMLInputElement);

  const draw = () => {
    if (!newest || !drawing) return;
    const { bodies, tool, width_m, things } = newest;
    tick += 1;
    const gripper = width_m === null ? null : { width_m, holding: false, closing: null };
    const state = /** @type {State} */ (/** @type {unknown} */ ({ tick, bodies, tool, gripper, things, belief: null, zone: null }));
    drawing.show(state, NOTHING_PREDICTED, [], { ...settings.values, showGhosts: false });
  };
  const show = (/** @type {Moment} */ moment) => {
    newest = moment;
    seek.value = String(moment.t);
    const time = say("history.time_of", { now: timeWords(moment.t), all: timeWords(player?.length ?? 0) });
    setText(byId("replay-time"), time);
    seek.setAttribute("aria-valuetext", time);
    setText(byId("replay-now"), say(moment.stopped ? "history.was_stopped" : moment.enabled ? "history.was_enabled" : "history.was_before"));
    draw();
  };
  byId("play").addEventListener("click", () => (player?.playing ? player.pause() : player?.play()));
  seek.addEventListener("input", () => {
    drawing?.clearTrail();
    player?.seek(Number(seek.value));
  });
  byId("replay-close").addEventListener("click", () => {
    player?.pause();
    byId("replay").hidden = true;
    history.replaceState(null, "", location.pathname);
  });
  settings.addEventListener("change", draw);

  return {
    repaint: () => drawing?.repaint(),
    /** Show a drive from its start. @param {Drive} drive @param {string} title */
    async open(drive, title) {
      player?.pause();
      if (scene && scene !== drive.scene) {
        location.hash = drive.id;
        location.reload();
        return;
      }
      const trace = await ask("GET", `/records/drives/${drive.id}/trace`);
      history.replaceState(null, "", `#${drive.id}`);
      byId("replay").hidden = false;
      setText(byId("replay-title"), title);
      player = new Player(trace);
      seek.max = String(player.length);
      player.addEventListener("moment", (event) => show(/** @type {CustomEvent} */ (event).detail));
      player.addEventListener("playing", () => setText(byId("play"), say(player?.playing ? "history.pause" : "history.play")));
      drawing?.clearTrail();
      player.seek(0);
      byId("replay-title").focus({ preventScroll: true });
      byId("replay").scrollIntoView({ block: "nearest" });
      if (scene || !drive.scene) return;
      scene = drive.scene;
      await attachViews(settings, say("drive.cannot_draw"), (loaded) => {
        drawing = loaded;
        draw();
      }, `/records/scenes/${scene}`);
    },
  };
}
