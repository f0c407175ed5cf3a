/** The Drive page: puts its parts together. */

import { attachBelief } from "./belief.js";
import { motionWords, placeWords } from "../views/directions.js";
import { attachDpad } from "../inputs/dpad.js";
import { attachFrame, part, write } from "../layout/page.js";
import { attachGamepad } from "../inputs/gamepad.js";
import { Inputs } from "../inputs/inputs.js";
import { attachKeyboard } from "../inputs/keyboard.js";
import { attachModes } from "./modes.js";
import { personal, listGhosts } from "../views/predictions.js";
import { attachRecording } from "./recording.js";
import { attachScanning, DIRECTION_CHOICES } from "../inputs/scanning.js";
import { attachSeat } from "../connection/driver_lease.js";
import { NO_PROFILE } from "../settings/settings.js";
import { attachStick } from "../inputs/stick.js";
import { attachTrialBanner, TRIAL } from "../personalise/trial.js";

/** Words beside the views change no more often than this, ms. */
const WORDS_MS = 250;

/** @type {import("../views/drawing.js").Drawing | null} */
let drawing = null;
const { settings, connection, status, seat, stop } = attachFrame({ drop: () => inputs.drop(), repaint: () => drawing?.repaint() });

/** From the stick to what is sent, for the mode that is on. @param {number} x @param {number} y @returns {number[]} */
function shaped(x, y) {
  const [right, up] = settings.shape(x, y);
  const { state, welcome } = connection;
  if (state?.mode === "end_effector") {
    // The server's axes are the base frame's: forward and left, up and turn, roll and pitch.
    const facing = settings.values.seat === "facing" && state.axes === 0;
    return (facing ? [-up, right] : [up, -right]).map((value) => value + 0);
  }
  return welcome?.latent_dim === 1 ? [right] : [right, up];
}

const inputs = new Inputs(connection, shaped);
inputs.addEventListener("halted", (event) => status.halted(/** @type {CustomEvent} */ (event).detail));

/** The seat first, if it is free, and then the arm: one press for both. */
const enable = () => {
  if (!connection.engaged) seat.ask(() => inputs.enable());
};
part("enable").addEventListener("click", enable);

const modes = attachModes({ mode: part("mode"), axes: part("axes") }, connection);
attachSeat({ text: part("seat"), ask: part("ask"), handOver: part("hand-over"), release: part("release") }, connection);
attachTrialBanner(connection, settings, seat);
attachRecording({ button: part("record"), task: part("record-task"), text: part("record-text"), teach: part("record-teach") }, connection);

const refused = () => status.halted("the arm is not enabled");
attachStick(part("stick"), part("stick-value"), inputs, settings);
attachDpad(part("dpad"), part("dpad-help"), inputs, settings, refused);
const switches = attachScanning(
  { list: part("scan"), press: part("switch"), next: part("switch-next"), help: part("scan-help") },
  inputs, settings, () => {
    const mode = { id: "mode", label: "Other mode", act: modes.next };
    return inputs.live ? [...DIRECTION_CHOICES, mode, { id: "stop", label: "Stop", act: stop }]
      : [{ id: "enable", label: "Enable", act: enable }, mode];
  },
);
attachKeyboard(inputs, settings, { enable, nextMode: modes.next, axes: modes.axes });
attachGamepad(inputs, settings, { enable, stop, press: switches.press });

const belief = attachBelief({
  list: part("belief"), none: part("belief-none"), level: part("help-level"),
  alpha: part("alpha"), alphaText: part("alpha-text"),
});
const ghostList = listGhosts(part("ghosts"));
part("trail-clear").addEventListener("click", () => connection.send("trail_clear"));
part("reset").addEventListener("click", () => connection.send("reset"));

for (const radio of document.querySelectorAll("input[name=panel]")) {
  radio.addEventListener("change", () => settings.change({ panel: /** @type {HTMLInputElement} */ (radio).value }));
}

const loading = import("../views/drawing.js").then(({ Drawing }) =>
  Drawing.load({ canvas: part("scene"), front: part("view-front"), side: part("view-side") }));
loading.then(
  (loaded) => {
    drawing = loaded;
    show();
  },
  (error) => {
    part("scene-lost").hidden = false;
    part("scene-lost").textContent = "This browser cannot draw the views. Everything else works.";
    console.error(error);
  },
);

/** @returns {import("../inputs/dpad.js").Direction[]} */
function pressed() {
  const said = /** @type {import("../inputs/dpad.js").Direction[]} */ ([]);
  const size = Math.max(Math.abs(inputs.x), Math.abs(inputs.y));
  if (inputs.y > 0.4 * size) said.push("up");
  if (inputs.y < -0.4 * size) said.push("down");
  if (inputs.x > 0.4 * size) said.push("right");
  if (inputs.x < -0.4 * size) said.push("left");
  return said;
}

let wordsAt = -Infinity;

function show() {
  const { state, welcome } = connection;
  part("enable").setAttribute("aria-disabled", String(connection.engaged || !connection.open));
  if (!state || !welcome) return;
  const paths = personal(state.ghosts, state.tool, shaped);
  drawing?.show(state, paths, pressed(), settings.values);
  belief.show(state.belief, state.alpha);
  if (performance.now() - wordsAt < WORDS_MS) return;
  wordsAt = performance.now();
  ghostList.show(paths, pressed(), (motion) => motionWords(motion, settings.values.seat));
  write(part("scene-text"), placeWords(state.tool, welcome.goals));
  part("bound-text").hidden = !settings.values.showBound || state.bound_m === null;
  if (state.bound_m !== null) write(part("bound-text"), `Help may hold the tool within ${Math.round(100 * state.bound_m)} cm of the likeliest goal.`);
  part("reset").disabled = connection.engaged;
}

function applySettings() {
  const { panel, seat } = settings.values;
  for (const name of ["stick", "dpad", "switch"]) part(`panel-${name}`).hidden = name !== panel;
  /** @type {any} */ (document.querySelector(`input[name=panel][value=${panel}]`)).checked = true;
  part("view-front").querySelector("figcaption").textContent = seat === "facing" ? "Front" : "Over the shoulder";
  part("ghosts").parentElement.hidden = !settings.values.showGhosts;
}

settings.addEventListener("change", () => {
  if (settings.values.panel !== lastPanel) inputs.drop();
  lastPanel = settings.values.panel;
  applySettings();
  chooseProfile();
  show();
});
let lastPanel = settings.values.panel;
applySettings();

let profileAsked = "";

/** The person's alignment, once they drive and the arm stands still; asked for once. Without a wish the server's stays. */
function chooseProfile() {
  const { state, welcome } = connection;
  const { profile } = settings.values;
  const known = profile === NO_PROFILE || welcome?.profiles.includes(profile);
  // What is being tried is not put aside by an older choice.
  if (!known || !connection.driving || connection.engaged || profile === profileAsked || state.profile === TRIAL) return;
  profileAsked = profile;
  const name = profile === NO_PROFILE ? null : profile;
  if (name !== state.profile) connection.send("profile", { name });
}

connection.addEventListener("welcome", () => {
  belief.name(connection.welcome.goals);
});
let trail = 0;
connection.addEventListener("state", () => {
  if (connection.state.trail !== trail) drawing?.clearTrail();
  trail = connection.state.trail;
  chooseProfile();
  show();
});
connection.addEventListener("line", show);
inputs.addEventListener("change", show);
