/** Drives day by day or week by week. */

/** @import {DriveRecord} from "../connection/messages.js" */

/** A drive, and how often each stopped the arm. @typedef {DriveRecord & {stops_by: Record<"person" | "page" | "arm", number>}} Drive */

/** A day, or a week from Monday on, with its first day, `YYYY-MM-DD`. @typedef {{first: string, drives: Drive[]}} Period */

const DAY_MS = 24 * 3600 * 1000;
/** Weeks in a chart: the last ones. */
export const MOST_WEEKS = 12;
/** Drives of no more days than these are compared day by day. */
export const MOST_DAYS = 14;

/** The day of a moment where the page is read. @param {string} iso */
export function dayOf(iso) {
  const at = new Date(iso);
  return written(Date.UTC(at.getFullYear(), at.getMonth(), at.getDate()));
}

/** The Monday of a moment's week. @param {string} iso */
export function mondayOf(iso) {
  const day = dayOf(iso);
  return later(day, -((new Date(day).getUTCDay() + 6) % 7));
}

/** Whether drives are few days apart: days then say more than weeks. @param {Drive[]} drives */
export function inDays(drives) {
  const days = drives.map(({ started }) => dayOf(started)).sort();
  return !days.length || days[days.length - 1] < later(days[0], MOST_DAYS);
}

/** Every day from the first drive to the last, without gaps. @param {Drive[]} drives */
export function byDay(drives) {
  return compared(drives, dayOf, 1);
}

/** Every week from the first drive to the last, without gaps; the last ones. @param {Drive[]} drives */
export function byWeek(drives) {
  return compared(drives, mondayOf, 7).slice(-MOST_WEEKS);
}

/** @param {Drive[]} drives @param {(iso: string) => string} firstDay of the period of a moment @param {number} days in a period @returns {Period[]} */
function compared(drives, firstDay, days) {
  const found = Map.groupBy(drives, ({ started }) => firstDay(started));
  const firsts = [...found.keys()].sort();
  const periods = [];
  for (let first = firsts[0]; first <= firsts[firsts.length - 1]; first = later(first, days)) periods.push({ first, drives: found.get(first) ?? [] });
  return periods;
}

/** Values with how often they are there, the most frequent first. @param {string[]} values @returns {[string, number][]} */
export function counted(values) {
  const counts = [...Map.groupBy(values, (value) => value)].map(([value, alike]) => /** @type {[string, number]} */ ([value, alike.length]));
  return counts.sort(([, one], [, other]) => other - one);
}

/** @param {string} day @param {number} days */
function later(day, days) {
  return written(Date.parse(day) + days * DAY_MS);
}

/** @param {number} ms */
function written(ms) {
  return new Date(ms).toISOString().slice(0, 10);
}
