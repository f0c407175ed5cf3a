/** The Personalise page: motions are shown, the stick answers, and what was learned can be tried and kept. */

import { attachDpad } from "../inputs/dpad.js";
import { attachGamepad } from "../inputs/gamepad.js";
import { attachInputChoice } from "../inputs/input_choice.js";
import { buttonChoice, linkChoices, moreChoices } from "../inputs/scan_choices.js";
import { attachKeyboard } from "../inputs/keyboard.js";
import { attachScanning, directionChoices } from "../inputs/scanning.js";
import { latentInput } from "../inputs/shaping.js";
import { attachStick, deflectionWords } from "../inputs/stick.js";
import { byId, fillBar, setText } from "../layout/dom.js";
import { attachPage } from "../layout/page.js";
import { say, sayNotice, sayPercent } from "../layout/words.js";
import { attachViews } from "../views/attach_views.js";
import { motionWords } from "../views/directions.js";
import { displacement, NOTHING_PREDICTED } from "../views/predictions.js";
import { AnswerInput } from "./answer_input.js";
import { Replay } from "./replay.js";
import { missedWords, STEPS, stepOf } from "./steps.js";
import { attachTrial, TRIAL } from "./trial.js";

/** @type {Drawing | null} */
let drawing = null;
/** The server's state of it. @type {Personalise | null} */
let state = null;
/** Whether a person who has been asked wants to be asked again. */
let again = location.hash === "#again";
/** Whether this page has asked for a trial, and goes to drive once it is there. */
let leaving = false;

/** Buttons of each step, most wanted first. @type {Record<string, string[]>} */
const STEP_BUTTONS = {
  begin: ["begin-go"], working: ["working-cancel"], learned: ["try", "keep", "discard", "ask-again"],
  refused: ["refused-again"], kept: ["another"],
};

const input = new AnswerInput();
const { settings, connection, lease, stop } = attachPage({ drop: () => input.neutral(), repaint: () => drawing?.repaint() });
const trial = attachTrial(connection, settings, lease);
const begin = /** @type {{person: HTMLInputElement, questions: HTMLSelectElement}} */ (
  /** @type {unknown} */ (byId("begin", HTMLFormElement).elements)
);

const stick = attachStick(input, settings);
attachDpad(input, settings);
attachInputChoice(input, settings);
const scanner = attachScanning(input, settings, stop, offered);
attachKeyboard(input, settings, { enable: answer });
attachGamepad(input, settings, scanner, { enable: answer, stop });

/** A switch's choices at each step: the step's own buttons, and then the pages and settings. @param {Choice} _ @param {Group} group @returns {Choice[]} */
function offered(_, group) {
  const step = stepOf(state, again);
  if (step !== "asking") return [...STEP_BUTTONS[step].flatMap(buttonChoice), ...linkChoices(byId(step)), moreChoices([], [], group)];
  const choices = [
    ...directionChoices(),
    { id: "answer", label: say("personalise.send"), act: answer },
    { id: "skip", label: say("personalise.skip"), act: skip },
    { id: "again", label: say("personalise.show_again"), act: () => replay.again() },
  ];
  const backs = state?.back ? [{ id: "back", label: say("personalise.back"), act: back }] : [];
  return [...choices, ...backs, ...buttonChoice("answer-cancel"), moreChoices([], [], group)];
}

/** The stick's meaning now; null where it is at rest for the person. Their speed is in the motion that is shown. */
function meant() {
  const u = input.answer && latentInput({ ...settings.values, sensitivity: 1 }, connection.welcome, ...input.answer);
  return u?.some((value) => value !== 0) ? u : null;
}

function answer() {
  const u = meant();
  if (input.live && state && u) lease.send({ type: "answer", question: state.question, u });
}

function skip() {
  if (input.live && state) lease.send({ type: "skip_question", question: state.question });
}

function back() {
  if (input.live && state?.back) lease.send({ type: "question_before", question: state.question });
}

const replay = new Replay(
  (bodies) => drawing?.showPose(bodies, settings.values.seat),
  (bodies) => drawing?.shadow(bodies),
  () => settings.values.sensitivity,
);

byId("begin").addEventListener("submit", (event) => {
  event.preventDefault();
  again = false;
  lease.send({ type: "personalise", name: begin.person.value, questions: Number(begin.questions.value), seat: settings.values.seat });
});
byId("answer-send").addEventListener("click", answer);
byId("answer-skip").addEventListener("click", skip);
byId("answer-again").addEventListener("click", () => replay.again());
byId("answer-back").addEventListener("click", back);
for (const id of ["answer-cancel", "working-cancel", "refused-again", "another"]) {
  byId(id).addEventListener("click", () => lease.send({ type: "cancel_personalise" }));
}
byId("try").addEventListener("click", () => {
  leaving = true;
  lease.ask(() => {
    // The alignment stands between the stick and the learned motions.
    if (connection.state?.mode === "end_effector") connection.send({ type: "mode", mode: "latent" });
    connection.send({ type: "try_alignment" });
  });
});
byId("keep").addEventListener("click", trial.keep);
byId("discard").addEventListener("click", trial.discard);
byId("ask-again").addEventListener("click", () => {
  again = true;
  show();
});

input.addEventListener("answer", showAnswer);
settings.addEventListener("change", showAnswer);

function showAnswer() {
  stick.mark(input.answer);
  const given = meant() && input.answer;
  setText(byId("answer"), given ? say("personalise.answer", { answer: deflectionWords(...given) }) : say("personalise.answer_none"));
  byId("answer-send", HTMLButtonElement).disabled = !given;
}

function show() {
  const now = stepOf(state, again);
  const hadFocus = /** @type {HTMLElement | null} */ (document.activeElement?.closest(".step") ?? null);
  for (const name of STEPS) byId(name).hidden = name !== now;
  // Who was on a button that is gone goes on at the new step.
  if (hadFocus?.hidden) byId(now).querySelector("h2")?.focus({ preventScroll: true });
  byId("problem").hidden = !state?.why || now === "refused";
  setText(byId("problem"), state?.why ? sayNotice(state.why) : "");
  // Who begins by a switch types no name.
  if (now === "begin") begin.person.value ||= state?.name || settings.name || (scanner.on ? say("settings.guest") : "");
  if (state && now === "asking") setText(byId("question"), say("personalise.question_of", { number: state.number, of: state.of }));
  if (state && now === "working") showWorking(state);
  if (state && now === "learned") showLearned(state);
  if (state?.why && now === "refused") setText(byId("refused-text"), sayNotice(state.why));
  if (state && now === "kept") setText(byId("kept-title"), say("personalise.kept", { name: state.name }));
  fillBar(byId("questions-bar"), (state?.number ?? 1) - 1, state?.of || 1);
  byId("answer-back", HTMLButtonElement).disabled = !state?.back;
}

/** @param {Personalise} personalise */
function showWorking({ phase, share }) {
  if (phase !== "preparing" && phase !== "thinking" && phase !== "learning") return;
  setText(byId("working-title"), say(`personalise.${phase}`));
  setText(byId("working-text"), say(phase === "preparing" ? "personalise.preparing_text" : "personalise.seconds"));
  fillBar(byId("working-bar"), Math.round(100 * share));
}

/** @param {Personalise} personalise */
function showLearned({ name, answers, error, error_without }) {
  setText(byId("learned-title"), say("personalise.learned", { name }));
  setText(byId("learned-text"), say("personalise.learned_text", { count: answers }));
  setText(byId("missed-with"), missedWords(error));
  setText(byId("missed-without"), missedWords(error_without));
}

/** Which question is shown; it may come again after a reload. */
let asked = -1;

function showQuestion() {
  const motion = state?.phase === "asking" ? state.motion : null;
  const question = state && motion ? state.question : -1;
  if (question === asked || !drawing) return;
  asked = question;
  drawing.showToolPaths(motion?.tools ?? []);
  replay.play(motion);
  if (!motion) {
    input.end();
    showArm();
    return;
  }
  input.begin();
  if (settings.values.panel === "stick") byId("stick").focus({ preventScroll: true });
  const moved = motionWords(displacement(motion.tools[0]), settings.values.seat);
  setText(byId("scene-text"), say("personalise.motion", { motion: moved, speed: sayPercent(settings.values.sensitivity) }));
}

/** The arm itself, where no motion is shown. */
function showArm() {
  if (asked !== -1 || !connection.state) return;
  setText(byId("scene-text"), "");
  drawing?.show(connection.state, NOTHING_PREDICTED, [], { ...settings.values, showGhosts: false, showTrail: false });
}

connection.addEventListener("learning", () => {
  state = connection.learning?.personalise ?? null;
  show();
  showQuestion();
});
connection.addEventListener("state", () => {
  showArm();
  if (!leaving || connection.state?.profile !== TRIAL) return;
  leaving = false;
  location.assign("/");
});
setText(byId("stick-how"), say("personalise.stick_help"));
showAnswer();
show();

attachViews(settings, say("personalise.cannot_draw"), (loaded) => {
  drawing = loaded;
  showArm();
  showQuestion();
});
