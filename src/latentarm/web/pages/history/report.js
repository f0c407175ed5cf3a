/** The care report: one page on paper about the drives that are listed. */

import { create } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { sayTime } from "../records/ask.js";
import { charts, chartsTitle } from "./charts.js";
import { inputWords, outcomeWords, stoppedBy, taskWords, timeWords } from "./drive_words.js";
import { FIGURES, figureOf } from "./figures.js";
import { counted } from "./weeks.js";

/** @import {Figure} from "./figures.js" */

/** Rows that a page has room for. */
const [MOST_TASKS, MOST_DRIVES] = [4, 6];
/** @type {Figure[]} */
const TASK_FIGURES = ["drives", "success", "time", "stops_person"];

/** @param {Drive[]} drives the newest first @param {string} name whom it is about @returns {HTMLElement[]} */
export function report(drives, name) {
  const date = (/** @type {string} */ iso) => sayTime(iso, { dateStyle: "medium" });
  const head = create("h2", { textContent: say("report.title_of", { name }) });
  const period = drives.length
    ? say("report.period", { since: date(drives[drives.length - 1].started), until: date(drives[0].started) })
    : say("report.nothing");
  const honest = say(drives.some(({ real }) => real) ? "report.real" : "report.simulated");
  const parts = [head, create("p", { textContent: period }), create("p", { className: "honest", textContent: honest })];
  if (!drives.length) return parts;
  return [
    ...parts, summary(drives), titled(chartsTitle(drives), create("div", { className: "charts" }, ...charts(drives))),
    titled(say("report.tasks"), taskTable(drives)), titled(say("report.latest"), driveTable(drives)),
    create("p", { className: "small", textContent: FIGURES.map((figure) => say(/** @type {WordKey} */ (`report.${figure}_means`))).join(" ") }),
    create("p", { className: "small", textContent: say("report.made", { when: sayTime(new Date().toISOString()) }) }),
  ];
}

/** @param {Drive[]} drives */
function summary(drives) {
  return create("dl", { className: "figures" }, ...FIGURES.map((figure) => (
    create("div", {}, create("dt", { textContent: title(figure) }), create("dd", { textContent: figureOf(figure, drives) })))));
}

/** @param {Figure} figure */
function title(figure) {
  return say(/** @type {WordKey} */ (`report.${figure}`));
}

/** @param {Drive[]} drives */
function taskTable(drives) {
  const rows = counted(drives.map(taskWords)).slice(0, MOST_TASKS).map(([task]) => {
    const here = drives.filter((drive) => taskWords(drive) === task);
    return [task, ...TASK_FIGURES.map((figure) => figureOf(figure, here))];
  });
  return table([say("history.task"), ...TASK_FIGURES.map(title)], rows);
}

/** @param {Drive[]} drives */
function driveTable(drives) {
  const rows = drives.slice(0, MOST_DRIVES).map((drive) => [
    sayTime(drive.started), drive.title.slice(0, 40) || taskWords(drive).slice(0, 40), drive.inputs.map(inputWords).join(", "), timeWords(drive.time_s),
    stoppedBy(drive), outcomeWords(drive),
  ]);
  const heads = [say("report.when"), say("history.task"), say("history.input"), say("report.time_one"), say("report.stops_one"), say("report.outcome")];
  return table(heads, rows);
}

/** @param {string[]} heads @param {string[][]} rows */
function table(heads, rows) {
  const row = (/** @type {string[]} */ texts, /** @type {"th" | "td"} */ tag) => create("tr", {}, ...texts.map((textContent) => create(tag, { textContent, dir: "auto" })));
  return create("table", {}, create("thead", {}, row(heads, "th")), create("tbody", {}, ...rows.map((texts) => row(texts, "td"))));
}

/** @param {string} title @param {HTMLElement} content */
function titled(title, content) {
  return create("section", {}, create("h3", { textContent: title }), content);
}
