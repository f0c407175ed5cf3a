/** The Teach page: recorded episodes are chosen, a run is trained on them, and driven. */

import { attachFrame, part, write } from "../layout/page.js";
import { attachSeat } from "../connection/driver_lease.js";

/** How long a run that was asked for may take to be there, ms. */
const LOADING_MS = 20_000;
/** Episodes without which nothing can be trained. */
const FEWEST = 3;

/** The run that this page goes to drive once it is loaded, and until when. */
let going = { run: "", until: -Infinity };

const { connection, seat } = attachFrame({ otherRun: () => {} });
attachSeat({ text: part("seat"), ask: part("ask"), handOver: part("hand-over"), release: part("release") }, connection);

/** Whether somebody else drives, who alone may train and choose. */
let watching = false;

/** Episodes that the person has left out. @type {Set<number>} */
const leftOut = new Set();

/** @type {HTMLFormElement} */
const form = part("train");
const fields = /** @type {any} */ (form.elements);

/** Whoever presses takes the wheel if it is free. @param {string} type @param {object} [fields] */
function tell(type, fields) {
  seat.ask(() => connection.send(type, fields));
}

/** @param {string} run */
function drive(run) {
  going = { run, until: performance.now() + LOADING_MS };
  if (connection.workshop?.run === run) location.assign("/");
  else tell("run", { run });
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  tell("train", {
    name: fields.name.value.trim(),
    model: fields.model.value,
    latent_dim: Number(fields.latent_dim.value),
    episodes: chosen().map((one) => one.number),
  });
});
fields.model.addEventListener("change", showHelp);
part("training-cancel").addEventListener("click", () => tell("cancel_training"));
part("training-drive").addEventListener("click", () => drive(connection.workshop.training.run));

/** @returns {{number: number, task: string, seconds: number}[]} */
function chosen() {
  return (connection.workshop?.recordings ?? []).filter((/** @type {any} */ one) => !leftOut.has(one.number));
}

function showHelp() {
  write(part("model-help"), fields.model.selectedOptions[0]?.dataset.help ?? "");
}

let listed = "";

function showEpisodes() {
  const { recordings } = connection.workshop;
  part("recorded-none").hidden = recordings.length > 0;
  part("episodes").hidden = recordings.length === 0;
  write(part("record-more"), recordings.length > 0 ? "Record more" : "Record on the Drive page");
  const now = JSON.stringify(recordings);
  if (now !== listed) part("episodes").querySelector("ul").replaceChildren(...recordings.map(episode));
  listed = now;
  const count = chosen().length;
  const missing = FEWEST - count;
  write(part("chosen"), recordings.length === 0 ? ""
    : missing > 0 ? `${count} chosen; ${missing} more ${missing === 1 ? "is" : "are"} needed.`
      : `${count} of ${recordings.length} chosen. One of them is kept to test what was learned, one to say when to stop.`);
}

/** @param {{number: number, task: string, seconds: number}} recorded */
function episode(recorded) {
  const { number, task, seconds } = recorded;
  const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: !leftOut.has(number) });
  box.addEventListener("change", () => {
    if (box.checked) leftOut.delete(number);
    else leftOut.add(number);
    show();
  });
  const label = Object.assign(document.createElement("label"), { className: "check" });
  label.append(box, text("span", task ? `Episode ${number}: ${task}` : `Episode ${number}`), text("span", `${seconds.toFixed(1)} s`));
  const row = document.createElement("li");
  row.append(label);
  return row;
}

/** @param {string} tag @param {string} content */
function text(tag, content) {
  return Object.assign(document.createElement(tag), { textContent: content });
}

/** @type {Record<string, (run: string) => string>} */
const TITLES = {
  exporting: (run) => `Getting ${run} ready …`,
  training: (run) => `Training ${run} …`,
  done: (run) => `${run} is trained.`,
  failed: (run) => (run ? `${run} was not trained.` : "Nothing was trained."),
  cancelled: (run) => `The training of ${run} was cancelled; nothing of it is kept.`,
};

/** Of the training, as it was shown last. */
let shownPhase = "";

function showTraining() {
  const { training } = connection.workshop;
  part("training").hidden = training === null;
  const busy = ["exporting", "training"].includes(training?.phase);
  part("train-begin").disabled = watching || busy || chosen().length < FEWEST;
  part("train-seat").hidden = !watching;
  if (training === null) return;
  const { phase, run, epoch, epochs, why } = training;
  write(part("training-title"), TITLES[phase](run));
  const share = phase === "done" ? 100 : epochs ? Math.round((100 * epoch) / epochs) : 0;
  part("training-bar").hidden = !busy && phase !== "done";
  part("training-bar").setAttribute("aria-valuenow", String(share));
  part("training-bar").firstElementChild.style.width = `${share}%`;
  write(part("training-text"), busy || phase === "done" ? progress(training) : "");
  part("training-why").hidden = why === null;
  write(part("training-why"), why ?? "");
  part("training-cancel").hidden = !busy;
  part("training-cancel").disabled = watching;
  part("training-drive").hidden = phase !== "done";
  part("training-drive").disabled = watching;
  // What the person waits for comes into sight, once.
  if (phase !== shownPhase && connection.driving) part("training").scrollIntoView({ block: "nearest" });
  shownPhase = phase;
}

/** @param {any} training */
function progress({ phase, epoch, epochs, loss, seconds_left }) {
  if (phase === "exporting") return "Reading the episodes: a few seconds.";
  const parts = epochs && phase === "training" ? [`Pass ${epoch} of at most ${epochs}`] : [];
  if (phase === "done" && epochs) parts.push(epoch < epochs ? `${epoch} passes, until it got no better` : `${epoch} passes`);
  if (loss !== null) parts.push(`loss ${loss.toFixed(3)}`);
  if (seconds_left !== null) parts.push(`up to about ${Math.ceil(seconds_left)} s left`);
  return parts.join(" · ");
}

let shelved = "";

function showRuns() {
  const { runs, run } = connection.workshop;
  part("runs-none").hidden = runs.length > 0;
  const now = JSON.stringify([runs, run, watching]);
  if (now !== shelved) {
    part("runs").replaceChildren(...runs.map((/** @type {string} */ name) => {
      const row = document.createElement("li");
      const label = text("span", name);
      if (name === run) label.append(text("small", "loaded now"));
      const button = /** @type {HTMLButtonElement} */ (text("button", "Drive it"));
      button.type = "button";
      button.setAttribute("aria-label", `Drive it: ${name}`);
      button.disabled = watching;
      button.addEventListener("click", () => drive(name));
      row.append(label, button);
      return row;
    }));
  }
  shelved = now;
}

function show() {
  if (!connection.workshop) return;
  showEpisodes();
  showTraining();
  showRuns();
}

/** A name that is not taken: at first, and once a run has the one that is written here. */
function suggestName() {
  const { runs, training } = connection.workshop;
  const { value } = fields.name;
  const used = training?.phase === "done" && training.run === value;
  if (value && !used) return;
  const stem = (value || "taught").replace(/-\d+$/, "");
  let number = 1;
  while (runs.includes(`${stem}-${number}`)) number += 1;
  fields.name.value = `${stem}-${number}`;
}

connection.addEventListener("workshop", () => {
  suggestName();
  show();
  if (connection.workshop.run === going.run && performance.now() < going.until) location.assign("/");
});
connection.addEventListener("state", () => {
  const { driver, you } = connection.state;
  const now = driver !== null && !you;
  if (now === watching) return;
  watching = now;
  show();
});
showHelp();
