/** Small charts: a bar for each week, with its value in figures, and all of it in words. */

import { create } from "../layout/dom.js";
import { say, sayNumber, sayPercent } from "../layout/words.js";
import { sayTime } from "../records/ask.js";
import { byWeek } from "./weeks.js";

/** @import {Drive, Week} from "./weeks.js" */

const SVG = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT, TOP, FOOT] = [300, 120, 18, 18];

/** @type {[import("../layout/words.js").WordKey, (week: Week) => number | null, (value: number) => string][]} */
const CHARTS = [
  ["history.chart_success", ({ success }) => success, (value) => sayPercent(value)],
  ["history.chart_time", ({ timeS }) => timeS, (value) => sayNumber(value, value < 10 ? 1 : 0)],
  ["history.chart_stops", ({ stops }) => stops, (value) => sayNumber(value, 1)],
];

/** Success, time and stops over the weeks. @param {Drive[]} drives @returns {HTMLElement[]} */
export function charts(drives) {
  const weeks = byWeek(drives);
  return CHARTS.map(([title, value, words]) => chart(say(title), weeks, value, words));
}

/**
 * @param {string} title
 * @param {Week[]} weeks
 * @param {(week: Week) => number | null} value
 * @param {(value: number) => string} words
 */
function chart(title, weeks, value, words) {
  const figure = create("figure", { className: "chart" });
  figure.append(create("figcaption", { textContent: title }));
  const known = weeks.filter((week) => value(week) !== null);
  if (!known.length) {
    figure.append(create("p", { className: "muted small", textContent: say("history.chart_nothing") }));
    return figure;
  }
  const svg = element("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" });
  const told = known.map((week) => say("history.chart_week", { week: day(week.monday), value: words(Number(value(week))) }));
  svg.setAttribute("aria-label", `${title}. ${told.join(" ")}`);
  const most = Math.max(...known.map((week) => Number(value(week))), 1e-9);
  const step = WIDTH / weeks.length;
  const wide = Math.min(0.7 * step, 36);
  weeks.forEach((week, index) => {
    const middle = (index + 0.5) * step;
    const height = ((HEIGHT - TOP - FOOT) * Number(value(week) ?? 0)) / most;
    const y = HEIGHT - FOOT - height;
    if (value(week) !== null) {
      svg.append(element("rect", { class: "bar-week", x: middle - wide / 2, y, width: wide, height: Math.max(height, 1) }));
      svg.append(element("text", { x: middle, y: y - 4, "text-anchor": "middle" }, words(Number(value(week)))));
    }
    if (weeks.length <= 6 || index % 2 === 0) {
      svg.append(element("text", { class: "axis-text", x: middle, y: HEIGHT - 4, "text-anchor": "middle" }, day(week.monday)));
    }
  });
  svg.append(element("line", { class: "base", x1: 0, x2: WIDTH, y1: HEIGHT - FOOT, y2: HEIGHT - FOOT }));
  figure.append(svg);
  return figure;
}

/** @param {string} monday */
function day(monday) {
  return sayTime(`${monday}T12:00:00Z`, { day: "numeric", month: "numeric" });
}

/** @param {string} name @param {Record<string, string | number>} attributes @param {string} [text] */
function element(name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  if (text !== undefined) made.textContent = text;
  return made;
}
