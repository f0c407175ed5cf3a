/** The Personalise page: motions are shown, the stick answers, and what was learned can be tried and kept. */

import { Answering } from "./answering.js";
import { attachDpad } from "../inputs/dpad.js";
import { motionWords } from "../views/directions.js";
import { attachFrame, part, write } from "../layout/page.js";
import { attachGamepad } from "../inputs/gamepad.js";
import { attachKeyboard } from "../inputs/keyboard.js";
import { Replay } from "./replay.js";
import { attachScanning, DIRECTION_CHOICES } from "../inputs/scanning.js";
import { attachSeat } from "../connection/driver_lease.js";
import { attachStick, words } from "../inputs/stick.js";
import { attachTrial, TRIAL } from "./trial.js";

const STEPS = ["begin", "asking", "working", "learned", "kept"];

/** @type {import("../views/drawing.js").Drawing | null} */
let drawing = null;
/** @type {any} What the server says of it; null where there is nothing. */
let state = null;
/** Whether a person who has been asked wants to be asked again. */
let again = location.hash === "#again";
/** Whether this page has asked for a trial, and goes to drive once it is there. */
let leaving = false;

const inputs = new Answering();
const { settings, connection, seat, stop } = attachFrame({ drop: () => inputs.drop(), repaint: () => drawing?.repaint() });
attachSeat({ text: part("seat"), ask: part("ask"), handOver: part("hand-over"), release: part("release") }, connection);
const trial = attachTrial(connection, settings, seat);

/** As the person drives: with their dead zone, sensitivity and swapped axes. @param {[number, number]} at */
function shaped(at) {
  const [right, up] = settings.shape(...at);
  return connection.welcome?.latent_dim === 1 ? [right] : [right, up];
}

/** Whoever presses takes the wheel if it is free. @param {string} type @param {object} [fields] */
function tell(type, fields) {
  seat.ask(() => connection.send(type, fields));
}

const stick = attachStick(part("stick"), part("stick-value"), inputs, settings);
attachDpad(part("dpad"), part("dpad-help"), inputs, settings, () => {});
const switches = attachScanning(
  { list: part("scan"), press: part("switch"), next: part("switch-next"), help: part("scan-help") }, inputs, settings, offered,
);
attachKeyboard(inputs, settings, { enable: answer, nextMode: () => {}, axes: () => {} });
attachGamepad(inputs, settings, { enable: answer, stop, press: switches.press });

/** @returns {import("../inputs/scanning.js").Choice[]} */
function offered() {
  const choices = [...DIRECTION_CHOICES, { id: "answer", label: "This is my answer", act: answer },
    { id: "skip", label: "I would not know", act: skip }, { id: "again", label: "Show again", act: () => replay.again() }];
  return state?.back ? [...choices, { id: "back", label: "Back", act: back }] : choices;
}

/** What the stick means now, or null where it is at rest for this person. */
function meant() {
  const u = inputs.answer && shaped(inputs.answer);
  return u?.some((value) => value !== 0) ? u : null;
}

function answer() {
  const u = meant();
  if (inputs.live && u) tell("answer", { question: state.question, u });
}

function skip() {
  if (inputs.live) tell("skip_question", { question: state.question });
}

function back() {
  if (inputs.live && state.back) tell("question_before", { question: state.question });
}

const replay = new Replay(
  (bodies) => drawing?.showPose(bodies, /** @type {"facing" | "behind"} */ (settings.values.seat)),
  (bodies) => drawing?.shadow(bodies),
);

part("begin").addEventListener("submit", (/** @type {SubmitEvent} */ event) => {
  event.preventDefault();
  const { person, questions } = part("begin").elements;
  again = false;
  tell("personalise", { name: person.value, questions: Number(questions.value) });
});
part("answer-send").addEventListener("click", answer);
part("answer-skip").addEventListener("click", skip);
part("answer-again").addEventListener("click", () => replay.again());
part("answer-back").addEventListener("click", back);
for (const id of ["answer-cancel", "working-cancel", "another"]) {
  part(id).addEventListener("click", () => tell("cancel_personalise"));
}
part("try").addEventListener("click", () => {
  leaving = true;
  seat.ask(() => {
    // The alignment stands between the stick and the learned motions.
    if (connection.state.mode === "end_effector") connection.send("mode", { mode: "latent" });
    connection.send("try_alignment");
  });
});
part("keep").addEventListener("click", () => trial.keep());
part("discard").addEventListener("click", () => tell("discard_alignment"));
part("ask-again").addEventListener("click", () => {
  again = true;
  show();
});

inputs.addEventListener("answer", showAnswer);
settings.addEventListener("change", () => {
  showPanel();
  showAnswer();
});

function showAnswer() {
  stick.mark(inputs.answer);
  const u = meant();
  write(part("answer"), `Your answer: ${u && inputs.answer ? words(...inputs.answer) : "none yet"}`);
  part("answer-send").disabled = !u;
}

function showPanel() {
  for (const name of ["stick", "dpad", "switch"]) part(`panel-${name}`).hidden = name !== settings.values.panel;
  /** @type {any} */ (document.querySelector(`input[name=panel][value=${settings.values.panel}]`)).checked = true;
  part("view-front").querySelector("figcaption").textContent = settings.values.seat === "facing" ? "Front" : "Over the shoulder";
}

for (const radio of document.querySelectorAll("input[name=panel]")) {
  radio.addEventListener("change", () => {
    inputs.drop();
    settings.change({ panel: /** @type {HTMLInputElement} */ (radio).value });
  });
}

/** Which step of the page is on. */
function step() {
  const phase = state?.phase;
  if (again && ["learned", "kept"].includes(phase)) return "begin";
  return { asking: "asking", preparing: "working", thinking: "working", learning: "working", learned: "learned", kept: "kept" }[phase] ?? "begin";
}

/** @type {Record<string, string>} */
const WORKING = { preparing: "Getting ready …", thinking: "Choosing the next motion …", learning: "Learning what you mean …" };

function show() {
  const now = step();
  const hadFocus = document.activeElement?.closest(".step") ?? null;
  for (const name of STEPS) part(name).hidden = name !== now;
  // Whoever sat on a button that is gone goes on at the new step.
  if (hadFocus?.hidden) part(now).querySelector("h2").focus({ preventScroll: true });
  part("problem").hidden = !state?.why;
  write(part("problem"), state?.why ?? "");
  if (now === "begin") showBegin();
  if (now === "asking") write(part("question"), `Question ${state.number} of at most ${state.of}`);
  if (now === "working") showWorking();
  if (now === "learned") showLearned();
  if (now === "kept") write(part("kept-title"), `The alignment of ${state.name} is kept.`);
  bar(part("questions-bar"), (state?.number ?? 1) - 1, state?.of || 1);
  part("answer-back").disabled = !state?.back;
}

function showBegin() {
  const { person } = part("begin").elements;
  if (!person.value) person.value = state?.name || settings.name;
}

function showWorking() {
  write(part("working-title"), WORKING[state.phase]);
  bar(part("working-bar"), Math.round(100 * state.share), 100);
  write(part("working-text"), state.phase === "preparing" ? "The run is loaded and motions are chosen: a few seconds." : "This takes a few seconds.");
}

function showLearned() {
  const { name, answers, error, error_without } = state;
  write(part("learned-title"), `The robot has learned what ${name} means.`);
  write(part("learned-text"), `From ${answers} ${answers === 1 ? "answer" : "answers"}. By how much it misses the motions that you meant:`);
  write(part("missed-with"), percent(error));
  write(part("missed-without"), percent(error_without));
}

/** @param {number} share */
function percent(share) {
  return share < 0.1 ? `${(100 * share).toFixed(1)} %` : `${Math.round(100 * share)} %`;
}

/** @param {HTMLElement} element @param {number} done @param {number} all */
function bar(element, done, all) {
  element.setAttribute("aria-valuemax", String(all));
  element.setAttribute("aria-valuenow", String(done));
  /** @type {HTMLElement} */ (element.firstElementChild).style.width = `${(100 * done) / all}%`;
}

/** Which question is shown; it may come again after a reload. */
let asked = -1;

function showQuestion() {
  const motion = state?.phase === "asking" ? state.motion : null;
  const question = motion ? state.question : -1;
  if (question === asked || !drawing) return;
  asked = question;
  drawing.showWays(motion?.tools ?? []);
  replay.play(motion);
  if (!motion) {
    inputs.end();
    showArm();
    return;
  }
  inputs.begin();
  if (settings.values.panel === "stick") part("stick").focus({ preventScroll: true });
  const [way] = motion.tools;
  const moved = way[way.length - 1].map((/** @type {number} */ end, /** @type {number} */ axis) => end - way[0][axis]);
  write(part("scene-text"), `The tool: ${motionWords(moved, settings.values.seat)}, shown slowly.`);
}

/** The arm itself, where no motion is shown. */
function showArm() {
  if (asked !== -1 || !connection.state) return;
  write(part("scene-text"), "");
  drawing?.show(connection.state, /** @type {any} */ ({}), [], { ...settings.values, showGhosts: false, showTrail: false, showBound: false });
}

const loading = import("../views/drawing.js").then(({ Drawing }) =>
  Drawing.load({ canvas: part("scene"), front: part("view-front"), side: part("view-side") }));
loading.then(
  (loaded) => {
    drawing = loaded;
    showArm();
    showQuestion();
  },
  (error) => {
    part("scene-lost").hidden = false;
    part("scene-lost").textContent = "This browser cannot draw the views. Without them nobody can answer.";
    console.error(error);
  },
);

connection.addEventListener("workshop", () => {
  state = connection.workshop.personalise;
  show();
  showQuestion();
});
connection.addEventListener("state", () => {
  showArm();
  if (!leaving || connection.state.profile !== TRIAL) return;
  leaving = false;
  location.assign("/");
});
write(part("stick-help"), "Push and let go: the dot stays. Push again to change it. The arrow keys do the same.");
showPanel();
showAnswer();
show();
