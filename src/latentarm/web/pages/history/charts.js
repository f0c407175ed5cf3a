/** Small charts: a bar for each day or week, with its value in figures, and all of it in words. */

import { create, part } from "../layout/dom.js";
import { say, sayNumber } from "../layout/words.js";
import { sayTime } from "../records/ask.js";
import { COUNTED } from "./figures.js";
import { byDay, byWeek, inDays } from "./weeks.js";

/** @import {Counted} from "./figures.js" */
/** @import {Period} from "./weeks.js" */

const [WIDTH, HEIGHT, TOP, FOOT] = [300, 124, 20, 24];
/** Values and days that there is room for, one next to the other. */
const [MOST_VALUES, MOST_DATES] = [8, 4];

/** @type {[WordKey, Counted, (value: number) => string][]} */
const CHARTS = [
  ["history.chart_success", "success", (value) => sayNumber(100 * value)],
  ["history.chart_time", "time", (value) => sayNumber(value, value < 10 ? 1 : 0)],
  ["history.chart_stops", "stops_person", (value) => sayNumber(value, 1)],
];

/** The title of the charts. @param {Drive[]} drives */
export function chartsTitle(drives) {
  return say(inDays(drives) ? "history.days" : "history.weeks");
}

/** Three figures over the days or weeks. @param {Drive[]} drives @returns {HTMLElement[]} */
export function charts(drives) {
  const daily = inDays(drives);
  const periods = daily ? byDay(drives) : byWeek(drives);
  const told = (/** @type {string} */ day, /** @type {string} */ value) =>
    daily ? say("history.chart_day", { day, value }) : say("history.chart_week", { week: day, value });
  return CHARTS.map(([title, figure, words]) => chart(say(title), periods, ({ drives: here }) => COUNTED[figure](here), words, told));
}

/**
 * @param {string} title @param {Period[]} periods @param {(period: Period) => number | null} value @param {(value: number) => string} words
 * @param {(day: string, value: string) => string} told a period in a sentence
 */
function chart(title, periods, value, words, told) {
  const known = periods.filter((period) => value(period) !== null);
  const figure = (/** @type {Element} */ content) => create("figure", { className: "chart" }, create("figcaption", { textContent: title }), content);
  if (!known.length) return figure(create("p", { className: "muted small", textContent: say("history.chart_nothing") }));
  const svg = part("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" });
  const sentences = known.map((period) => told(date(period.first), words(Number(value(period)))));
  svg.setAttribute("aria-label", `${title}. ${sentences.join(" ")}`);
  const most = Math.max(...known.map((period) => Number(value(period))), 1e-9);
  const step = WIDTH / periods.length;
  const [everyValue, everyDate] = [MOST_VALUES, MOST_DATES].map((room) => Math.ceil(periods.length / room));
  const wide = Math.min(0.7 * step, 36);
  periods.forEach((period, index) => {
    const middle = (index + 0.5) * step;
    const amount = value(period);
    if (amount !== null) {
      const height = ((HEIGHT - TOP - FOOT) * amount) / most;
      const y = HEIGHT - FOOT - height;
      if (amount > 0) svg.append(part("rect", { class: "bar-period", x: middle - wide / 2, y, width: wide, height }));
      if (index % everyValue === 0) svg.append(part("text", { x: middle, y: y - 4, "text-anchor": "middle" }, words(amount)));
    }
    if (index % everyDate === 0) {
      svg.append(part("text", { class: "axis-text", x: middle, y: HEIGHT - 5, "text-anchor": "middle" }, date(period.first)));
    }
  });
  svg.append(part("line", { class: "base", x1: 0, x2: WIDTH, y1: HEIGHT - FOOT, y2: HEIGHT - FOOT }));
  return figure(svg);
}

/** @param {string} day `YYYY-MM-DD` */
function date(day) {
  return sayTime(`${day}T00:00:00`, { day: "numeric", month: "numeric" });
}
