/** Directions and places in the words of the person, who sits facing the arm or behind it. */

const LEAST_M = 0.01;
/** A part of a motion is named where it is at least this share of the largest part. */
const NAMED_SHARE = 0.4;

/**
 * @param {number[]} motion in the arm's base frame, m: x away from the base, y to its left, z up
 * @param {string} seat "facing" or "behind"
 */
export function motionWords(motion, seat) {
  const side = seat === "behind" ? 1 : -1;
  const [x, y, z] = motion;
  const parts = /** @type {[number, string][]} */ ([
    [Math.abs(z), z > 0 ? "up" : "down"],
    [Math.abs(x), side * x > 0 ? "away from you" : "towards you"],
    [Math.abs(y), side * y > 0 ? "left" : "right"],
  ]).sort((a, b) => b[0] - a[0]);
  const length = Math.hypot(x, y, z);
  if (length < LEAST_M) return "hardly moves, or turns";
  const named = parts.filter(([size]) => size >= NAMED_SHARE * parts[0][0]).map(([, word]) => word);
  return `${named.join(", ")}: ${Math.round(length * 100)} cm`;
}

/**
 * @param {number[]} tool m
 * @param {{name: string, position: number[]}[]} goals
 */
export function placeWords(tool, goals) {
  const height = `The tool is ${Math.round(tool[2] * 100)} cm up`;
  const near = goals
    .map((goal) => ({ name: goal.name, away: Math.hypot(...goal.position.map((at, axis) => at - tool[axis])) }))
    .sort((a, b) => a.away - b.away)[0];
  return near ? `${height}, ${Math.round(near.away * 100)} cm from ${near.name}.` : `${height}.`;
}
