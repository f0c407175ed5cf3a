/** Drives week by week, and in all: the figures behind the charts and the report. */

/**
 * @typedef {object} Drive as `DriveRecord` of the server has it
 * @property {string} id
 * @property {string | null} person
 * @property {string} title
 * @property {string} started
 * @property {number} time_s
 * @property {number} moving_s
 * @property {string} task
 * @property {string | null} choice
 * @property {string | null} run
 * @property {string[]} modes
 * @property {string[]} inputs
 * @property {number} presses
 * @property {number} stops
 * @property {number} late_stops
 * @property {number} way_m
 * @property {number | null} help
 * @property {string | null} help_level
 * @property {number | null} steps_done
 * @property {number | null} steps
 * @property {"success" | "failure" | null} outcome
 * @property {string | null} scene
 */

/**
 * @typedef {object} Week
 * @property {string} monday `YYYY-MM-DD`
 * @property {number} drives how many
 * @property {number | null} success share of those that ended well or badly; null where none did either
 * @property {number | null} timeS median, s; null without drives
 * @property {number | null} stops for each drive; null without drives
 */

const DAY_MS = 24 * 3600 * 1000;
/** Weeks in a chart: the last ones. */
export const MOST_WEEKS = 12;

/** The Monday of a moment's week. @param {string} iso */
export function mondayOf(iso) {
  const day = new Date(`${iso.slice(0, 10)}T00:00:00Z`);
  return dayOf(day.getTime() - ((day.getUTCDay() + 6) % 7) * DAY_MS);
}

/** Every week from the first drive to the last, without gaps. @param {Drive[]} drives @returns {Week[]} */
export function byWeek(drives) {
  if (!drives.length) return [];
  const mondays = drives.map(({ started }) => mondayOf(started)).sort();
  const last = mondays[mondays.length - 1];
  const weeks = [];
  for (let monday = mondays[0]; monday <= last; monday = dayOf(Date.parse(`${monday}T00:00:00Z`) + 7 * DAY_MS)) {
    const here = drives.filter(({ started }) => mondayOf(started) === monday);
    weeks.push({ monday, drives: here.length, ...figures(here) });
  }
  return weeks.slice(-MOST_WEEKS);
}

/** @param {Drive[]} drives @returns {{success: number | null, timeS: number | null, stops: number | null}} */
export function figures(drives) {
  const judged = drives.filter(({ outcome }) => outcome !== null);
  const done = judged.filter(({ outcome }) => outcome === "success");
  return {
    success: judged.length ? done.length / judged.length : null,
    timeS: median(drives.map(({ time_s }) => time_s)),
    stops: drives.length ? sum(drives.map(({ stops }) => stops)) / drives.length : null,
  };
}

/** @param {number[]} values @returns {number | null} null without values */
export function median(values) {
  const sorted = [...values].sort((one, other) => one - other);
  const middle = sorted.length >> 1;
  if (!sorted.length) return null;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/** @param {number[]} values */
export function sum(values) {
  return values.reduce((total, value) => total + value, 0);
}

/** Values with how often they are there, the most frequent first. @param {string[]} values @returns {[string, number][]} */
export function counted(values) {
  /** @type {Map<string, number>} */
  const counts = new Map();
  for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1);
  return [...counts].sort(([, one], [, other]) => other - one);
}

/** @param {number} ms */
function dayOf(ms) {
  return new Date(ms).toISOString().slice(0, 10);
}
