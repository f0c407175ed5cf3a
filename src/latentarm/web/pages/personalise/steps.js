/** The steps of the Personalise page. */

import { sayPercent } from "../layout/words.js";

/** @typedef {"begin" | "asking" | "working" | "learned" | "refused" | "kept"} Step */

/** @type {Step[]} */
export const STEPS = ["begin", "asking", "working", "learned", "refused", "kept"];

/** @type {Record<Personalise["phase"], Step>} */
const STEP_OF = {
  preparing: "working", asking: "asking", thinking: "working", learning: "working", learned: "learned", refused: "refused", kept: "kept", failed: "begin",
};

/** @param {Personalise | null} personalise null where nobody was asked @param {boolean} again whether a person who has been asked wants to be asked again */
export function stepOf(personalise, again) {
  if (personalise === null) return "begin";
  const step = STEP_OF[personalise.phase];
  return again && (step === "learned" || step === "kept") ? "begin" : step;
}

/** An alignment's error in words; small ones with a decimal. @param {number | null} share */
export function missedWords(share) {
  if (share === null) return "–";
  return sayPercent(share, share < 0.1 ? 1 : 0);
}
