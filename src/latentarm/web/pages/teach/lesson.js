/** The arm's lesson, in words first: whether it is good enough to drive, and what to record again. */

import { say, sayNumber } from "../layout/words.js";

/** @import {Lesson, Recorded} from "../connection/messages.js" */

/** A recording that lasts for less than this share of the usual one is short. */
const SHORT_SHARE = 0.5;

/** Names of the axes of the stick, in the order in which the server counts them. */
const AXES = /** @type {const} */ (["across", "along"]);

/** The verdict, and then what could be better. @param {Lesson} lesson @returns {{good: boolean, text: string}[]} */
export function lessonWords({ short, speeds_m_s, weak }) {
  const all = speeds_m_s.length;
  const rows = [];
  if (weak.length === all) rows.push({ good: false, text: say("lesson.none_works") });
  else if (weak.length) rows.push(...weak.map((axis) => ({ good: false, text: say(`lesson.weak_${AXES[axis]}`) })));
  else rows.push({ good: true, text: say(all === 1 ? "lesson.works" : "lesson.both_work") });
  if (short.length) rows.push({ good: false, text: say("lesson.short", { count: short.length, numbers: short.join(", ") }) });
  return rows;
}

/** From how many recordings it learned, and how fast each direction moves the tool. @param {Lesson | null} lesson */
export function lessonFigures(lesson) {
  if (lesson === null) return [];
  const speeds = lesson.speeds_m_s.map((speed, axis) => say(`lesson.speed_${AXES[axis]}`, { centimetres: sayNumber(100 * speed, 1) }));
  return [say("lesson.learned_from", { count: lesson.learned_from, all: lesson.recordings }), ...speeds];
}

/** Numbers of the recordings that are much shorter than the others. @param {Recorded[]} recordings */
export function shortOnes(recordings) {
  const sorted = recordings.map(({ seconds }) => seconds).sort((one, other) => one - other);
  const usual = sorted[Math.floor(sorted.length / 2)];
  return recordings.filter(({ seconds }) => seconds < SHORT_SHARE * usual).map(({ number }) => number);
}
