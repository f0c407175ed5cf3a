/**
 * The page Check the fit: is an input, set as it is, right for this person? Nothing on it moves an arm: what is pushed is only
 * measured, and the page tells the server nothing but who sits here, and Stop.
 */

import { attachDpad } from "../inputs/dpad.js";
import { attachGamepad } from "../inputs/gamepad.js";
import { attachInputChoice } from "../inputs/input_choice.js";
import { attachKeyboard } from "../inputs/keyboard.js";
import { commonChoices } from "../inputs/scan_choices.js";
import { pageControls } from "../inputs/page_controls.js";
import { attachScanning } from "../inputs/scanning.js";
import { attachStick } from "../inputs/stick.js";
import { byId, create, fillBar, setHidden, setText, whenever } from "../layout/dom.js";
import { attachPage } from "../layout/page.js";
import { say } from "../layout/words.js";
import { AnswerInput } from "../personalise/answer_input.js";
import { mappingOf, stickOf } from "../settings/pads.js";
import { attachViews } from "../views/attach_views.js";
import { NOTHING_PREDICTED } from "../views/predictions.js";
import { CELLS, Hold, Trials } from "./exercises.js";
import { changes, findingsOf, proposals, textsOf } from "./results.js";

/** The settings under which each input is in use. @type {Record<string, Partial<Values>>} */
const INPUTS = {
  stick: { panel: "stick" }, keys: { panel: "dpad" }, pad: { panel: "stick" },
  switch: { panel: "switch", switches: "1" }, switches: { panel: "switch", switches: "2" },
};
const PRESSES = 8;
/** Nobody waits longer for a picture, such as one of a hidden page, ms. */
const LONGEST_MS = 2000;
/** Where there is room for every reason; elsewhere a question mark opens it. */
const ROOM = "(min-width: 40.01rem) and (min-height: 30.01rem)";
const WARNINGS = /** @type {const} */ (["fit.drift_much", "fit.slow", "fit.too_few"]);

/** @type {Drawing | null} */
let drawing = null;
let chosen = "stick";
/** What is done one after the other; of keys only a share. @type {(Hold | Trials | {share: number})[]} */
let exercises = [];
let at = 0;
/** From press to picture, ms. @type {Promise<number>[]} */
let timings = [];
/** @type {Partial<Values>} */
let proposed = {};
/** When the key or the pointer was moved that is being dealt with, ms; 0 for none. */
let eventAt = 0;

for (const type of ["keydown", "pointerdown", "pointermove"]) {
  // Before anybody else hears of it.
  window.addEventListener(type, ({ timeStamp }) => {
    eventAt = timeStamp;
    setTimeout(() => (eventAt = 0));
  }, { capture: true });
}
const input = new AnswerInput();
const { settings, connection, stop } = attachPage({ drop: () => input.neutral(), repaint: () => drawing?.repaint() });
const pad = () => navigator.getGamepads().find((one) => one?.connected);

attachStick(input, settings);
// Nothing stays where no hand is, whatever a press does.
window.addEventListener("pointerup", () => input.release("pointer"));
attachDpad(input, settings);
attachInputChoice(input, settings);
const scanner = attachScanning(input, settings, stop, offered);
attachKeyboard(input, settings, {});
attachGamepad(input, settings, scanner, { stop });

/** The cells of an exercise, else what stands on the page. @param {Choice} stopIt @param {Group} group @returns {Choice[]} */
function offered(stopIt, group) {
  const trials = exercises[at];
  if (!(trials instanceof Trials)) return [...pageControls(byId("controls"), group), ...commonChoices(group)];
  /** @type {Choice[]} */
  const cells = CELLS.map((label, index) => ({ id: `cell-${trials.done}-${index}`, label }));
  return [...cells, stopIt].map((choice, index) => ({ ...choice, act: () => {
    choice.act?.();
    trials.took(index);
    goOn();
  } }));
}

/** @param {string} step */
function show(step) {
  for (const name of ["choose", "exercise", "result"]) setHidden(byId(name), name !== step);
  byId(step).querySelector("h2")?.focus({ preventScroll: true });
}

function begin() {
  setHidden(byId("problem"), !connection.engaged);
  if (connection.engaged) {
    end();
    return;
  }
  const rest = new Hold(null, null);
  [at, timings] = [0, []];
  if (INPUTS[chosen].panel === "switch") exercises = [new Trials(scanner.style)];
  else exercises = chosen === "keys" ? [{ share: 0 }] : [rest, ...(/** @type {const} */ (["right", "up", "left", "down"])).map((one) => new Hold(one, rest))];
  setHidden(byId("fit-skip"), !(exercises[0] instanceof Hold));
  show("exercise");
  input.begin();
  tell();
}

function end(step = "choose") {
  exercises = [];
  input.end();
  show(step);
}

/** To the next exercise, where this one is done or cannot be. */
function goOn(isSkipped = false) {
  const now = exercises[at];
  if (!now) return;
  if (isSkipped && now instanceof Hold) now.samples = [];
  if (isSkipped || now.share >= 1) {
    at += 1;
    input.neutral();
  }
  if (at < exercises.length) tell();
  else void finish();
}

/** What is to be done now, and how much of it is done. */
function tell() {
  const now = exercises[at];
  if (now instanceof Trials) setText(byId("fit-task"), say("fit.choose_cell", { cell: now.named }));
  else if (!(now instanceof Hold)) setText(byId("fit-task"), say("fit.press"));
  else if (now.towards) setText(byId("fit-task"), say("fit.push", { direction: say(`directions.${now.towards}`) }));
  else setText(byId("fit-task"), say(chosen === "pad" ? "fit.rest_pad" : "fit.rest"));
  setText(byId("fit-wait"), chosen === "pad" && !pad() ? say("gamepad.none") : "");
  fillBar(byId("fit-bar"), now.share, 1);
}

async function finish() {
  const delays = await Promise.all(timings);
  if (!exercises.length) return;
  const { person, values } = settings;
  const findings = findingsOf(exercises, delays, values);
  proposed = proposals(findings, values);
  byId("findings").replaceChildren(...findings.map((finding) => {
    const [name, measured, change, why] = textsOf(finding, values);
    const open = matchMedia(ROOM).matches || WARNINGS.some((key) => why === say(key));
    const mark = create("summary", { ariaLabel: say("explain.what", { topic: name }) }, create("span", { ariaHidden: "true", textContent: "?" }));
    const reason = create("details", { className: "explain", open }, mark, create("p", { textContent: why }));
    return create("li", {}, create("strong", { textContent: name }), create("span", { textContent: measured }), create("span", { textContent: change }), reason);
  }));
  byId("changes").replaceChildren(...changes(findings, values.fit[chosen]).map((textContent) => create("li", { textContent })));
  const isNew = Object.keys(proposed).length > 0;
  setHidden(byId("fit-use"), !isNew);
  setText(byId("fit-keep"), say(isNew ? "fit.keep" : "fit.done"));
  setText(byId("fit-whose"), person ? say("fit.kept_with", { name: person.name }) : say("fit.kept_here"));
  if (findings.length) settings.change({ fit: { ...values.fit, [chosen]: { at: Date.now(), ...Object.fromEntries(findings.map(({ key, value }) => [key, value])) } } });
  end("result");
}

/** The push that is measured, before anything is made of it. */
function hand() {
  const one = chosen === "pad" ? pad() : null;
  if (one) return stickOf(mappingOf(settings.values.pads, one), one.axes);
  return chosen === "stick" && input.source === "pointer" ? [input.x, input.y] : null;
}

/** Time how long it takes from the press that is being dealt with until the arm has been drawn anew and the screen shows it. */
function timePress() {
  const since = eventAt || pad()?.timestamp || performance.now();
  timings.push(new Promise((resolve) => {
    const end = () => resolve(performance.now() - since);
    const drawn = () => requestAnimationFrame(() => requestAnimationFrame(end));
    setTimeout(end, LONGEST_MS);
    if (drawing) document.addEventListener("arm-drawn", drawn, { once: true });
    else drawn();
    drawing?.showToolPaths([]);
  }));
}

/** Which input is in use now, by this page or by the settings. */
function follow() {
  const isInUse = (/** @type {string} */ name) => Object.entries(INPUTS[name]).every(([key, value]) => settings.values[/** @type {keyof Values} */ (key)] === value);
  if (!isInUse(chosen)) {
    chosen = Object.keys(INPUTS).find(isInUse) ?? "stick";
    if (exercises.length) end();
  }
  for (const radio of /** @type {NodeListOf<HTMLInputElement>} */ (document.querySelectorAll("input[name=fit]"))) radio.checked = radio.value === chosen;
}

byId("fit-inputs").addEventListener("change", ({ target }) => {
  chosen = /** @type {HTMLInputElement} */ (target).value;
  settings.change(INPUTS[chosen]);
});
byId("fit-begin").addEventListener("click", begin);
byId("fit-skip").addEventListener("click", () => goOn(true));
byId("fit-cancel").addEventListener("click", () => end());
for (const [id, used] of /** @type {const} */ ([["fit-use", true], ["fit-keep", false]])) {
  byId(id).addEventListener("click", () => {
    if (used) settings.change(proposed);
    setText(byId("fit-said"), used ? say("fit.used") : "");
    end();
  });
}
input.addEventListener("poll", () => {
  const now = exercises[at];
  if (!(now instanceof Hold)) return;
  now.see(hand(), performance.now() / 1000);
  goOn();
});
input.addEventListener("turned", () => {
  if (!exercises[at] || input.source === null) return;
  timePress();
  if (chosen !== "keys") return;
  exercises = [{ share: exercises[0].share + 1 / PRESSES }];
  goOn();
});
scanner.addEventListener("change", () => {
  const now = exercises[at];
  if (now instanceof Trials && scanner.choices[scanner.lit]?.id.startsWith(`cell-${now.done}-`)) now.lit(scanner.lit, performance.now() / 1000);
});
scanner.addEventListener("switch", (event) => {
  const [now, { number, down }] = [exercises[at], /** @type {CustomEvent} */ (event).detail];
  if (!(now instanceof Trials) || number > 0) return;
  now.pressed(down, performance.now() / 1000);
  if (down) timePress();
});
connection.addEventListener("state", () => {
  if (connection.engaged && exercises.length) begin();
  if (connection.state) drawing?.show(connection.state, NOTHING_PREDICTED, [], { ...settings.values, showGhosts: false, showTrail: false });
});
whenever(settings, ["change"], follow);
attachViews(settings, say("fit.cannot_draw"), (loaded) => (drawing = loaded));
