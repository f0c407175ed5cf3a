/** Whether the robot knows what is meant, or only guesses. */

/** A goal is called the likeliest where its share is so many times that of a belief which prefers none. */
const CLEARLY = 1.2;

/** Whether a goal is what the robot takes to be meant. @param {number[] | null} belief @param {number} index */
export function isLikeliest(belief, index) {
  if (belief === null || belief.length < 2) return false;
  const most = Math.max(...belief);
  return belief[index] === most && most > CLEARLY / belief.length;
}
