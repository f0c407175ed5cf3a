/** The Drive page: puts its parts together. */

import { attachCopilot } from "../connection/copilot.js";
import { attachDpad } from "../inputs/dpad.js";
import { DriveInput } from "../inputs/drive_input.js";
import { attachGamepad } from "../inputs/gamepad.js";
import { attachGripper } from "../inputs/gripper.js";
import { attachInputChoice } from "../inputs/input_choice.js";
import { attachKeyboard } from "../inputs/keyboard.js";
import { attachLatchLimit } from "../inputs/latch_limit.js";
import { moreChoices } from "../inputs/page_choices.js";
import { attachScanning, directionChoices } from "../inputs/scanning.js";
import { modeInput } from "../inputs/shaping.js";
import { attachStick } from "../inputs/stick.js";
import { attachTremor } from "../inputs/tremor.js";
import { byId, setText } from "../layout/dom.js";
import { attachPage } from "../layout/page.js";
import { say } from "../layout/words.js";
import { attachTrialBanner } from "../personalise/trial.js";
import { attachViews } from "../views/attach_views.js";
import { motionWords, placeWords } from "../views/directions.js";
import { attachPredictions, personalPaths } from "../views/predictions.js";
import { attachBelief } from "./belief.js";
import { attachHelp } from "./help.js";
import { attachModes } from "./modes.js";
import { attachProfileChoice } from "./profile_choice.js";
import { attachRecording } from "./recording.js";

/** @import {Drawing} from "../views/drawing.js" */

/** Words next to the views change no more often than this, ms. */
const WORDS_MS = 250;

/** @type {Drawing | null} */
let drawing = null;
const { settings, connection, status, lease, stop } = attachPage({
  scans: true,
  drop: () => input.drop(),
  repaint: () => drawing?.repaint(),
});

const shaped = (/** @type {number} */ x, /** @type {number} */ y) =>
  modeInput(settings.values, connection.state, connection.welcome, x, y);

const input = new DriveInput(connection, shaped, attachTremor(settings));
attachLatchLimit(input, connection, settings);
input.addEventListener("halted", (event) => status.halted(/** @type {CustomEvent} */ (event).detail));

/** This page drives first, if nobody else does, and then enables the arm: one press for both. */
const enable = () => {
  if (!connection.engaged) lease.ask(() => input.enable());
};
byId("enable").addEventListener("click", enable);

const modes = attachModes({ mode: byId("mode"), axes: byId("axes") }, connection, settings);
const help = attachHelp({ fieldset: byId("help"), text: byId("help-text") }, connection, settings);
attachCopilot(connection);
attachTrialBanner(connection, settings, lease);
attachProfileChoice(connection, settings);
attachRecording({
  button: byId("record", HTMLButtonElement),
  task: byId("record-task", HTMLInputElement),
  text: byId("record-text"),
  teach: byId("record-teach"),
}, connection);

const gripper = attachGripper({
  panel: byId("gripper"),
  open: byId("gripper-open", HTMLButtonElement),
  close: byId("gripper-close", HTMLButtonElement),
  state: byId("gripper-state"),
}, connection, input, () => status.halted("not_enabled"));
attachStick(byId("stick"), byId("stick-value"), input, settings);
attachDpad(byId("dpad"), byId("dpad-help"), input, settings, () => status.halted("not_enabled"));
const scanner = attachScanning({
  list: byId("scan"),
  press: byId("switch", HTMLButtonElement),
  next: byId("switch-next", HTMLButtonElement),
  help: byId("scan-help"),
}, input, settings, () => {
  const mode = { id: "mode", label: say("scanning.other_mode"), act: modes.next };
  const stops = { id: "stop", label: say("layout.stop"), act: stop };
  const more = moreChoices(help.choices(), stops);
  return input.live ? [...directionChoices(), ...gripper.choices(), mode, stops, more]
    : [{ id: "enable", label: say("layout.enable"), act: enable }, mode, more];
});
attachKeyboard(input, settings, { enable, nextMode: modes.next, axes: modes.axes, gripper: () => gripper.toggle("keyboard") });
attachGamepad(input, settings, {
  enable, stop, gripper: () => gripper.toggle("gamepad"), press: (number, down) => scanner.press(number, down),
});
attachInputChoice(input, settings);

const belief = attachBelief({
  list: byId("belief"), none: byId("belief-none"), level: byId("help-level"),
  alpha: byId("alpha"), alphaText: byId("alpha-text"),
});
const predictions = attachPredictions(byId("ghosts"));
byId("trail-clear").addEventListener("click", () => connection.send({ type: "trail_clear" }));
byId("reset").addEventListener("click", () => connection.send({ type: "reset" }));

let wordsAt = -Infinity;

function show() {
  const { state, welcome } = connection;
  byId("enable").setAttribute("aria-disabled", String(connection.engaged || !connection.open));
  if (!state || !welcome) return;
  const { pressed } = input;
  const paths = personalPaths(state.ghosts, state.tool, shaped);
  drawing?.show(state, paths, pressed, settings.values);
  belief.show(state.belief, state.alpha);
  if (performance.now() - wordsAt < WORDS_MS) return;
  wordsAt = performance.now();
  predictions.show(paths, pressed, (motion) => motionWords(motion, settings.values.seat));
  setText(byId("scene-text"), placeWords(state.tool, welcome.goals));
  byId("bound-text").hidden = !settings.values.showBound || state.bound_m === null;
  if (state.bound_m !== null) setText(byId("bound-text"), say("drive.bound", { centimetres: Math.round(100 * state.bound_m) }));
  byId("reset", HTMLButtonElement).disabled = connection.engaged;
}

function showSettings() {
  const ghosts = byId("ghosts").parentElement;
  if (ghosts) ghosts.hidden = !settings.values.showGhosts;
  show();
}

settings.addEventListener("change", showSettings);
showSettings();

connection.addEventListener("welcome", () => belief.name(connection.welcome?.goals ?? []));
let trail = 0;
connection.addEventListener("state", () => {
  if (connection.state && connection.state.trail !== trail) {
    drawing?.clearTrail();
    trail = connection.state.trail;
  }
  show();
});
connection.addEventListener("open", show);
input.addEventListener("change", show);

attachViews(settings, say("drive.cannot_draw"), (loaded) => {
  drawing = loaded;
  show();
});
