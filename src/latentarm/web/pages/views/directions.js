/** Directions in the words of the person, who sits facing the arm or behind it. */

import { say } from "../layout/words.js";

const LEAST_M = 0.01;
/** A part of a motion is named where it is at least this share of the largest part. */
const NAMED_SHARE = 0.4;

/** @param {number[]} motion in the arm's base frame, m: x away from the base, y to its left, z up @param {Values["seat"]} seat */
export function motionWords(motion, seat) {
  const side = seat === "behind" ? 1 : -1;
  const [x, y, z] = motion;
  const length = Math.hypot(x, y, z);
  if (length < LEAST_M) return say("motion.hardly");
  const parts = [
    { size: Math.abs(z), word: say(z > 0 ? "motion.up" : "motion.down") },
    { size: Math.abs(x), word: say(side * x > 0 ? "motion.away" : "motion.towards") },
    { size: Math.abs(y), word: say(side * y > 0 ? "motion.left" : "motion.right") },
  ].sort((a, b) => b.size - a.size);
  const named = parts.filter(({ size }) => size >= NAMED_SHARE * parts[0].size).map(({ word }) => word);
  return say("motion.length", { directions: named.join(", "), centimetres: Math.round(length * 100) });
}
