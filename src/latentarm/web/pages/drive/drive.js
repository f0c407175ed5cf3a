/** The Drive page: puts its parts together. */

import { attachEnableButton, enableButtonOf } from "../connection/enable_button.js";
import { attachLostArm } from "../connection/lost_arm.js";
import { attachDialogs, dialogIsOpen } from "../inputs/dialogs.js";
import { attachCard } from "../card/card.js";
import { attachChatterGuard } from "../inputs/chatter.js";
import { attachCopilot } from "../connection/copilot.js";
import { DIRECTIONS } from "../inputs/deflection.js";
import { attachDpad } from "../inputs/dpad.js";
import { DriveInput } from "../inputs/drive_input.js";
import { attachGamepad } from "../inputs/gamepad.js";
import { attachGripper } from "../inputs/gripper.js";
import { attachInputChoice } from "../inputs/input_choice.js";
import { attachKeyboard } from "../inputs/keyboard.js";
import { paced } from "../inputs/paced.js";
import { attachLatchLimit } from "../inputs/latch_limit.js";
import { buttonChoice, moreChoices, radioChoices } from "../inputs/scan_choices.js";
import { attachScanning, directionChoices } from "../inputs/scanning.js";
import { modeInput } from "../inputs/shaping.js";
import { attachRim } from "../inputs/rim.js";
import { attachStick } from "../inputs/stick.js";
import { attachTremor } from "../inputs/tremor.js";
import { attachWatching } from "../inputs/watching.js";
import { byId, setText } from "../layout/dom.js";
import { attachPage } from "../layout/page.js";
import { say } from "../layout/words.js";
import { attachTrialBanner } from "../personalise/trial.js";
import { attachPractice } from "../practice/attach_practice.js";
import { attachViews } from "../views/attach_views.js";
import { motionWords } from "../views/directions.js";
import { personalPaths, personalRing, showPredictions } from "../views/predictions.js";
import { attachChecklist } from "./checklist.js";
import { attachHelp } from "./help.js";
import { attachModes, attachSpeed } from "./modes.js";
import { attachPoses } from "./poses.js";
import { attachThingsHere, seenWords } from "./things_here.js";
import { attachProfileChoice } from "./profile_choice.js";
import { attachRecording } from "./recording.js";
import { attachTask } from "./task_panel.js";
import { attachToGo, movedPart } from "./to_go.js";
import { wantedThing } from "./task_words.js";
import { whereWords } from "./where_words.js";
import { attachWayEnd } from "./way_end.js";
import { attachWayBack } from "./way_back.js";
import { attachZones } from "./zones.js";

/** Words next to the views change no more often than this, ms. */
const WORDS_MS = 250;

/** @type {Drawing | null} */
let drawing = null;
const { settings, connection, status, lease, stop, feedback } = attachPage({
  drop: () => {
    practice.stopped();
    input.drop();
  },
  repaint: () => drawing?.repaint(),
});

// In a study nothing is chosen here, and everybody drives at full speed.
const fixed = document.documentElement.hasAttribute("data-fixed");
const values = () => (fixed ? { ...settings.values, sensitivity: 1 } : settings.values);
const shaped = (/** @type {number} */ x, /** @type {number} */ y) =>
  modeInput(values(), connection.state, connection.welcome, x, y);

const input = new DriveInput(connection, shaped, attachTremor(settings));
attachLatchLimit(input, connection, settings, status.asksToPushAgain);
attachChatterGuard(input);
input.addEventListener("halted", (event) => status.halted(/** @type {CustomEvent} */ (event).detail));
attachDialogs(input);

const practice = attachPractice(connection, input, settings);
attachCard(connection, settings);

const checklist = attachChecklist(connection);

/** This page drives first, if nobody else does, and then enables the arm: one press for both. */
const enable = () => {
  // Behind a dialog nothing moves. A press that enables asks nobody for anything.
  if (dialogIsOpen()) return;
  if (connection.state?.lost) connectAgain();
  else if (!checklist.done()) {
    checklist.refuse();
    status.refused();
  } else if (!connection.driving && connection.state?.driver) status.refused();
  else if (!connection.engaged) lease.ask(() => input.enable());
};
attachEnableButton(byId("enable"), connection, enable);
const connectAgain = attachLostArm(connection, lease);
attachWayBack(connection);
const poseChoices = attachPoses(connection);
const thingChoices = attachThingsHere(connection);
const modes = attachModes(connection, settings);
const inPair = (/** @type {number} */ axes, /** @type {number} */ x, /** @type {number} */ y) =>
  connection.state ? modeInput(values(), { ...connection.state, mode: "end_effector", axes }, connection.welcome, x, y) : [0, 0];
const toGo = attachToGo(connection, inPair, () => settings.values.panel === "switch");
/** Where each direction leads, as drawn last. @type {Paths | null} */
let paths = null;
status.watch(() => ({
  slow: input.lateness.wasSlow, unconfirmed: !checklist.done(), dialog: dialogIsOpen(), pressed: input.source !== null,
  keys: document.documentElement.hasAttribute("data-keys"), practice: practice.step, next: toGo.next(paths),
}));
// In a study nobody is helped so.
const leads = () => settings.values.bestFirst && !fixed;
attachWayEnd(input, connection, toGo.left, leads);
attachSpeed(settings);
attachHelp(connection, settings);
attachCopilot(connection);
attachZones(connection);
attachTrialBanner(connection, settings, lease);
attachProfileChoice(connection, settings);
attachRecording(connection);

const taskChoices = attachTask(connection, feedback);
const gripper = attachGripper(connection, input, status.refused);
attachStick(input, settings);
const rim = attachRim();
attachDpad(input, settings, status.refused);
attachWatching([byId("stick"), byId("dpad")], connection, status.refused);
attachInputChoice(input, settings);
const scanner = attachScanning(input, settings, stop, (stopIt, group) => {
  const mode = { id: "mode", label: say("scanning.other_mode"), act: modes.next };
  const { label, does } = enableButtonOf(connection);
  if (does === "ask") return [{ id: "ask", label: say(label), act: () => connection.send({ type: "ask_to_drive" }) }, stopIt];
  // On the way back any press ends it.
  if (connection.state?.returning || !(connection.driving || does)) return [stopIt];
  const more = moreChoices(radioChoices(byId("help"), group), [
    ...(fixed ? [] : [...radioChoices(byId("speed"), group), ...buttonChoice("way-back"), ...poseChoices(), ...thingChoices()]), ...practice.choices(),
  ], group);
  if (connection.state?.lost) return [...buttonChoice("lost-again"), stopIt, more];
  const unconfirmed = checklist.choices();
  if (unconfirmed.length) return [...unconfirmed, stopIt, more];
  const best = leads() ? toGo.next(paths)?.choice : undefined;
  return input.live ? [...directionChoices(), ...gripper.choices(), mode, stopIt, more].map((one) => ({ ...one, first: one.id === best }))
    : [{ id: "enable", label: say("layout.enable"), act: enable }, mode, ...(fixed ? [] : taskChoices()), more];
});
attachKeyboard(input, settings, { enable, nextMode: modes.next, axes: modes.axes, gripper: () => gripper.toggle("keyboard") });
attachGamepad(input, settings, scanner, { enable, stop, gripper: () => gripper.toggle("gamepad"), nextMode: modes.next });

byId("trail-clear").addEventListener("click", () => connection.send({ type: "trail_clear" }));

let wordsAt = -Infinity;

/** @returns {boolean} whether the arm or a thing is drawn elsewhere. */
function show() {
  const { state, welcome } = connection;
  if (!state || !welcome) return false;
  const { pressed } = input;
  paths = personalPaths(state.ghosts, state.tool, shaped);
  const wanted = wantedThing(welcome, state);
  const ring = personalRing(state.ghosts, state.tool, shaped);
  const moved = drawing?.show(state, { paths, ring }, pressed, settings.values, wanted) ?? false;
  rim.toggleAttribute("hidden", !settings.values.showGhosts || shaped(1, 0).length < 2);
  if (performance.now() - wordsAt < WORDS_MS) return moved;
  wordsAt = performance.now();
  const pair = state.mode === "end_effector" ? welcome.end_effector_modes[state.axes] : null;
  const turns = (/** @type {Direction} */ direction) =>
    pair !== null && movedPart(pair, shaped(...DIRECTIONS[direction])).part.of === "turn_rad";
  showPredictions(paths, pressed, (motion, direction) =>
    turns(direction) ? say("motion.turns") : motionWords(motion, settings.values.seat));
  setText(byId("scene-text"), [whereWords(welcome, state, wanted), ...(state.things?.seen ?? []).map(seenWords)].filter(Boolean).join(" "));
  return moved;
}

function showSettings() {
  const { showGhosts, largeView } = settings.values;
  byId("ghosts").hidden = !showGhosts;
  byId("views").dataset.large = largeView;
  show();
}

settings.addEventListener("change", showSettings);
byId("view-swap").addEventListener("click", () => settings.change({ largeView: settings.values.largeView === "front" ? "side" : "front" }));
showSettings();

let placed = "";
connection.addEventListener("welcome", () => {
  const { task: todo } = /** @type {Welcome} */ (connection.welcome);
  const now = JSON.stringify([todo.name, todo.seed, todo.choice]);
  // The things about the arm are redrawn when they were placed anew.
  if (placed && placed !== now) void drawing?.renew();
  placed = now;
});
// Where inputs are late, less is shown.
const showSoon = paced(show, () => input.lateness.frameGapMs);
let trail = 0;
connection.addEventListener("state", () => {
  if (connection.state && connection.state.trail !== trail) {
    drawing?.clearTrail();
    trail = connection.state.trail;
  }
  showSoon();
});
connection.addEventListener("open", show);
input.addEventListener("change", showSoon);

const draw = () => attachViews(settings, say("drive.cannot_draw"), (loaded) => {
  drawing = loaded;
  byId("scene").addEventListener("webglcontextlost", () => input.halt("picture_lost"));
  drawing.pace(() => input.lateness.frameGapMs > 0, () => input.goFirst());
  show();
});
// A page that shows a camera draws no scene until the person asks for it.
if (document.getElementById("cameras")) {
  import("../cameras/cameras.js").then(({ attachCameras }) => attachCameras(settings, connection, draw));
} else draw();
