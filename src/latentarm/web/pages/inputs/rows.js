/** Long lists in rows: a row is chosen first, and then what is in it. Stop and the way back are choices of their own everywhere. */

import { say } from "../layout/words.js";
import { DIRECTIONS } from "./deflection.js";

/** A list that is no longer than this has no rows, and a row is no longer than that. */
const SHORT = 5;
const IN_A_ROW = 4;

/** @param {Choice[]} choices @returns {Choice[]} */
export function inRows(choices) {
  const isAlways = (/** @type {Choice} */ { id, back }) => id === "stop" || back;
  const [always, others] = [choices.filter(isAlways), choices.filter((choice) => !isAlways(choice))];
  if (others.length <= SHORT) return choices;
  const directions = others.filter(({ id }) => id in DIRECTIONS);
  const rest = others.filter(({ id }) => !(id in DIRECTIONS));
  const rows = directions.length ? [directions] : [];
  for (let at = 0; at < rest.length; at += IN_A_ROW) rows.push(rest.slice(at, at + IN_A_ROW));
  const stops = always.filter(({ back }) => !back);
  const [first, ...more] = rows.map((row) => rowOf(row, stops));
  return [first, ...stops, ...more, ...always.filter(({ back }) => back)];
}

/** @param {Choice[]} row @param {Choice[]} stops @returns {Choice} */
function rowOf(row, stops) {
  if (row.length === 1) return row[0];
  const id = `row-${row[0].id}`;
  const back = { id: `${id}-back`, label: say("scanning.back"), back: true };
  return { id, label: row.map(({ label }) => label).join(", "), row, first: row.some(({ first }) => first), inner: () => [...row, ...stops, back] };
}
