/** The History page: drives to filter, to look at again, to compare, to print, to rename and to delete. */

import { attachWholePage } from "../inputs/whole_page.js";
import { byId, create, createButton, setText } from "../layout/dom.js";
import { attachPage } from "../layout/page.js";
import { say, sayNotice, sayNumber } from "../layout/words.js";
import { ask, attempt, sayTime, showProblem } from "../records/ask.js";
import { charts, chartsTitle } from "./charts.js";
import { figureWords, inputWords, outcomeWords, taskWords } from "./drive_words.js";
import { attachReplay } from "./replay_panel.js";
import { report } from "./report.js";

/** @import {RecordingFile} from "../connection/messages.js" */

/** Drives that are listed at first, and more with each press. */
const PAGE = 25;
const GUEST = "";

/** @type {ReturnType<typeof attachReplay> | null} */
let replay = null;
const { settings, stop } = attachPage({ repaint: () => replay?.repaint(), runChanged: () => {} });
replay = attachReplay(settings);
attachWholePage(settings, stop);

const filters = byId("filters", HTMLFormElement);
const fields = /** @type {Record<"person" | "task" | "input" | "since" | "until", HTMLSelectElement | HTMLInputElement>} */ (
  /** @type {unknown} */ (filters.elements)
);
const renaming = byId("rename", HTMLDialogElement);
const newTitle = /** @type {HTMLInputElement} */ (renaming.querySelector("input"));

/** @type {Drive[]} */
let drives = [];
/** @type {Record<string, string>} */
let people = {};
let listed = PAGE;
let shown = "";
/** @type {(title: string) => Promise<unknown>} */
let rename = async () => {};
/** @type {() => Promise<unknown>} */
let undo = async () => {};

function query() {
  const given = /** @type {[string, string][]} */ ([...new FormData(filters)]);
  return new URLSearchParams(given.filter(([name, value]) => value !== "*" && (value || name === "person"))).toString();
}

async function refresh() {
  const found = await ask("GET", `/records/drives?${query()}`);
  ({ drives, people } = found);
  byId("csv", HTMLAnchorElement).href = `/records/drives.csv?${query()}`;
  setText(byId("weeks-title"), chartsTitle(drives));
  byId("charts").replaceChildren(...charts(drives));
  byId("report").replaceChildren(...report(drives, fields.person.value === "*" ? say("history.everybody") : nameOf(fields.person.value)));
  setText(byId("drives-title"), say("history.drives", { count: drives.length }));
  const problems = found.problem ? [found.problem] : found.problems;
  if (problems.length) showProblem(problems.map(sayNotice).join(" "));
  showDrives();
}

/** @param {string | null} person */
function nameOf(person) {
  return person ? people[person] ?? person : say("settings.guest");
}

/** Choices that there are, whatever is chosen now. */
async function fillFilters() {
  const all = await ask("GET", "/records/drives");
  people = all.people;
  const of = (/** @type {(drive: Drive) => string[]} */ what) => [...new Set(/** @type {Drive[]} */ (all.drives).flatMap(what))].sort();
  fill(fields.person, [...Object.entries(people), [GUEST, say("settings.guest")]]);
  fill(fields.task, of(({ task }) => [task]).map((task) => [task, taskWords({ task, choice: null })]));
  fill(fields.input, of(({ inputs }) => inputs).map((input) => [input, inputWords(input)]));
  if (settings.person && people[settings.person.id]) fields.person.value = settings.person.id;
}

/** @param {HTMLSelectElement | HTMLInputElement} select @param {string[][]} choices */
function fill(select, choices) {
  const options = [["*", say("history.all")], ...choices];
  select.replaceChildren(...options.map(([value, textContent]) => create("option", { value, textContent })));
}

function showDrives() {
  byId("drives").replaceChildren(...drives.slice(0, listed).map(driveRow));
  byId("more").hidden = drives.length <= listed;
}

/** @param {Drive} drive */
function titleOf(drive) {
  return drive.title || taskWords(drive);
}

/** @param {Drive} drive */
function driveRow(drive) {
  const when = sayTime(drive.started);
  const outcome = create("strong", { textContent: outcomeWords(drive), dataset: { outcome: drive.outcome ?? "" } });
  const label = `${titleOf(drive)}, ${when}`;
  const path = `/records/drives/${drive.id}`;
  const row = rowOf(titleOf(drive), `${when} · ${nameOf(drive.person)}`, [outcome, ` · ${figureWords(drive)}`], [
    ...(drive.scene ? [button("history.show", label, () => open(drive))] : []),
    ...changing(label, path, drive.title),
  ]);
  row.dataset.shown = String(drive.id === shown);
  return row;
}

/** @param {Drive} drive */
async function open(drive) {
  shown = drive.id;
  showDrives();
  await replay?.open(drive, `${titleOf(drive)} · ${sayTime(drive.started)}`);
}

async function showRecordings() {
  const { recordings } = await ask("GET", "/records/recordings");
  const rows = /** @type {RecordingFile[]} */ (recordings).map((one) => {
    const by = [...new Set(one.episodes.map(({ person }) => people[person] ?? person))].filter(Boolean).join(", ");
    const seconds = one.episodes.reduce((total, episode) => total + episode.seconds, 0);
    const figures = one.problem ? sayNotice(one.problem) : say("history.recorded", {
      count: one.episodes.length, seconds: sayNumber(seconds, 0), megabytes: sayNumber(one.bytes / 1e6, 1),
    });
    const path = `/records/recordings/${encodeURIComponent(one.name)}`;
    const tools = changing(one.title || one.name, path, one.title);
    if (one.in_use) tools[1].disabled = true;
    return rowOf(one.title || one.name, [one.title ? one.name : "", by].filter(Boolean).join(" · "), [figures], tools);
  });
  byId("recordings").replaceChildren(...(rows.length ? rows : [create("li", { className: "muted", textContent: say("history.no_recordings") })]));
}

/** Buttons that rename and delete. @param {string} label @param {string} path @param {string} title as it is now */
function changing(label, path, title) {
  return [
    button("history.rename", label, async () => {
      newTitle.value = title;
      rename = (text) => ask("PUT", path, { title: text });
      renaming.showModal();
    }),
    button("history.delete", label, async () => {
      await ask("DELETE", path);
      undo = () => ask("POST", `${path}/restore`);
      setText(byId("undo-text"), say("history.deleted", { title: label }));
      byId("undo-bar").hidden = false;
      byId("undo").focus();
      await all();
    }),
  ];
}

/** @param {string} title @param {string} about @param {(Node | string)[]} figures @param {HTMLElement[]} tools */
function rowOf(title, about, figures, tools) {
  const name = create("span", { className: "drive-name" }, create("bdi", { textContent: title }), create("small", { textContent: about }));
  return create("li", {}, name, create("span", { className: "drive-figures" }, ...figures), create("div", { className: "row" }, ...tools));
}

/** @param {"history.show" | "history.rename" | "history.delete"} word @param {string} label @param {() => Promise<unknown>} act */
function button(word, label, act) {
  return createButton(say(word), () => attempt(act), { ariaLabel: `${say(word)}: ${label}` });
}

async function all() {
  await refresh();
  await showRecordings();
}

filters.addEventListener("change", () => {
  listed = PAGE;
  attempt(refresh);
});
filters.addEventListener("submit", (event) => event.preventDefault());
byId("more").addEventListener("click", () => {
  listed += PAGE;
  showDrives();
});
byId("print").addEventListener("click", () => window.print());
byId("undo").addEventListener("click", () => attempt(async () => {
  await undo();
  byId("undo-bar").hidden = true;
  await all();
}));
byId("rename-cancel").addEventListener("click", () => renaming.close());
renaming.querySelector("form")?.addEventListener("submit", () => attempt(async () => {
  await rename(newTitle.value);
  await all();
}));

attempt(async () => {
  await fillFilters();
  await all();
  const wanted = drives.find(({ id }) => id === location.hash.slice(1));
  if (wanted) await open(wanted);
});
