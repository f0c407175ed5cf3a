/** The Teach page: recorded episodes are chosen, a run is trained on them, and driven. */

import { attachLostArm } from "../connection/lost_arm.js";
import { attachWholePage } from "../inputs/whole_page.js";
import { byId, create, createButton, fillBar, setText } from "../layout/dom.js";
import { attachPage } from "../layout/page.js";
import { say, sayNotice, sayNumber } from "../layout/words.js";
import { sayTime } from "../records/ask.js";
import { attachGuiding } from "./guiding.js";
import { lessonFigures, lessonWords, shortOnes } from "./lesson.js";
import { freeName, isBusy, leftWords, progressShare, progressWords } from "./training.js";

/** @import {Lesson, Recorded} from "../connection/messages.js" */

/** How long a run that was asked for may take to be there, ms: checking it may take a minute, and then it is loaded. */
const LOADING_MS = 90_000;
/** Episodes without which nothing can be trained. */
const FEWEST = 3;

/** The run that this page goes to drive once it is loaded, and until when. */
let going = { run: "", until: -Infinity };

const { connection, settings, lease, stop } = attachPage({ runChanged: () => {}, drop: () => stopGuiding() });
attachWholePage(settings, stop);
attachLostArm(connection, lease);
const stopGuiding = attachGuiding(connection, lease);

/** Whether somebody else drives, who alone may train and choose. */
let watching = false;

/** Episodes that the person has chosen or left out; else those of this start of the server are chosen. @type {Map<string, boolean>} */
const picked = new Map();

const form = byId("train", HTMLFormElement);
const fields = /** @type {{name: HTMLInputElement, model: HTMLSelectElement, latent_dim: RadioNodeList}} */ (
  /** @type {unknown} */ (form.elements)
);

/** @param {string} run */
function drive(run) {
  going = { run, until: performance.now() + LOADING_MS };
  if (connection.learning?.run === run) location.assign("/");
  else lease.send({ type: "run", run });
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  lease.send({
    type: "train",
    name: fields.name.value.trim(),
    model: fields.model.value,
    latent_dim: fields.latent_dim.value === "1" ? 1 : 2,
    episodes: chosen().map(({ file, episode }) => ({ file, episode })),
  });
});
fields.model.addEventListener("change", showHelp);
byId("training-cancel").addEventListener("click", () => lease.send({ type: "cancel_training" }));
byId("training-drive").addEventListener("click", () => {
  const training = connection.learning?.training;
  if (training) drive(training.run);
});

function chosen() {
  return (connection.learning?.recordings ?? []).filter(isChosen);
}

/** @param {Recorded} recorded */
function keyOf({ file, episode }) {
  return `${file} ${episode}`;
}

/** @param {Recorded} recorded */
function isChosen(recorded) {
  return picked.get(keyOf(recorded)) ?? !recorded.earlier;
}

function showHelp() {
  setText(byId("model-help"), fields.model.selectedOptions[0]?.dataset.help ?? "");
}

let listed = "";

/** @param {LearningState} learning */
function showEpisodes({ recordings }) {
  byId("recorded-none").hidden = recordings.length > 0;
  byId("episodes").hidden = recordings.length === 0;
  setText(byId("record-more"), say(recordings.length > 0 ? "teach.record_again" : "teach.record_more"));
  const now = JSON.stringify(recordings);
  if (now !== listed) list(recordings);
  listed = now;
  const count = chosen().length;
  const words = count < FEWEST ? say("teach.chosen_too_few", { chosen: count, count: FEWEST - count }) : say("teach.chosen", { chosen: count, all: recordings.length });
  setText(byId("chosen"), recordings.length ? words : "");
}

/** @param {Recorded[]} recordings */
function list(recordings) {
  const short = shortOnes(recordings);
  const [before, ofNow] = [true, false].map((earlier) => recordings.filter((one) => one.earlier === earlier));
  byId("episodes").querySelector("ul")?.replaceChildren(...ofNow.map((one) => row(one, short)));
  const earlier = byId("earlier", HTMLDetailsElement);
  earlier.hidden = before.length === 0;
  earlier.open ||= ofNow.length === 0;
  earlier.querySelector("ul")?.replaceChildren(...before.map((one) => row(one, short)));
  setText(/** @type {HTMLElement} */ (earlier.querySelector("summary")), say("teach.earlier", { count: before.length }));
}

/** @param {Recorded} recorded @param {number[]} short numbers of those that are short */
function row(recorded, short) {
  const { number, task, seconds, started, earlier } = recorded;
  const box = create("input", { type: "checkbox", checked: isChosen(recorded) });
  box.addEventListener("change", () => {
    picked.set(keyOf(recorded), box.checked);
    show();
  });
  const label = create("label", { className: "check" }, box,
    create("span", { textContent: task ? say("teach.episode_task", { number, task }) : say("teach.episode", { number }) }),
    create("span", { textContent: say("unit.seconds", { value: sayNumber(seconds, 1) }) }));
  if (earlier && started) label.append(create("small", { className: "muted", textContent: sayTime(started) }));
  if (short.includes(number)) label.append(create("strong", { className: "short", textContent: say("teach.short") }));
  return create("li", {}, label);
}

/** Of the training, as it was shown last. */
let shownPhase = "";

/** @param {LearningState} learning */
function showTraining({ training }) {
  const busy = isBusy(training);
  byId("training").hidden = training === null;
  byId("train-begin", HTMLButtonElement).disabled = watching || busy || chosen().length < FEWEST;
  byId("train-driver-only").hidden = !watching;
  if (training === null) return;
  const { phase, run, why } = training;
  setText(byId("training-title"), phase === "failed" && !run ? say("training.failed_unnamed") : say(`training.${phase}`, { run }));
  byId("training-bar").hidden = !busy && phase !== "done";
  fillBar(byId("training-bar"), progressShare(training));
  setText(byId("training-left"), busy ? leftWords(training) : "");
  const figures = busy || phase === "done" ? [progressWords(training), ...lessonFigures(training.lesson)].filter(Boolean).join(" · ") : "";
  setText(byId("training-text"), figures);
  byId("training-more").hidden = !figures;
  showLesson(training.lesson);
  byId("training-why").hidden = why.length === 0;
  setText(byId("training-why"), why.map(sayNotice).join(" "));
  byId("training-cancel").hidden = !busy;
  byId("training-cancel", HTMLButtonElement).disabled = watching;
  byId("training-drive").hidden = phase !== "done";
  byId("training-drive", HTMLButtonElement).disabled = watching;
  // The result that the person waits for scrolls into view, once.
  if (phase !== shownPhase && connection.driving) byId("training").scrollIntoView({ block: "nearest" });
  shownPhase = phase;
}

/** @param {Lesson | null} lesson */
function showLesson(lesson) {
  const list = byId("training-lesson");
  list.hidden = lesson === null;
  const rows = lesson === null ? [] : lessonWords(lesson);
  if (rows.map(({ text }) => text).join() === [...list.children].map((row) => row.textContent).join()) return;
  list.replaceChildren(...rows.map(({ good, text }) => create("li", { textContent: text, dataset: { good: String(good) } })));
}

let listedRuns = "";

/** @param {LearningState} learning */
function showRuns({ runs, run }) {
  byId("runs-none").hidden = runs.length > 0;
  const now = JSON.stringify([runs, run, watching]);
  if (now === listedRuns) return;
  listedRuns = now;
  byId("runs").replaceChildren(...runs.map((name) => {
    const label = create("span", { textContent: name });
    if (name === run) label.append(create("small", { textContent: say("teach.loaded") }));
    return create("li", {}, label, createButton(say("teach.drive"), () => drive(name), { disabled: watching, ariaLabel: say("teach.drive_run", { run: name }) }));
  }));
}

function show() {
  const { learning } = connection;
  if (!learning) return;
  showEpisodes(learning);
  showTraining(learning);
  showRuns(learning);
}

connection.addEventListener("learning", () => {
  const { learning } = connection;
  if (!learning) return;
  fields.name.value = freeName(fields.name.value, learning);
  show();
  if (learning.run === going.run && performance.now() < going.until) location.assign("/");
});
connection.addEventListener("state", () => {
  if (!connection.state) return;
  const { driver, you } = connection.state;
  const now = driver !== null && !you;
  if (now === watching) return;
  watching = now;
  show();
});
showHelp();
