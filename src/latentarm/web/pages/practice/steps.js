/** The guided practice: what a person does first, ticked off by what they really do. */

import { distance } from "../drive/task_words.js";

/** @typedef {"enable" | "press" | "watch" | "let_go" | "stop" | "reach"} Step */
/** The arm, as this page drives it, and whether a direction is pressed; m. @typedef {{engaged: boolean, moving: boolean, pressed: boolean, tool: number[], goals: number[][]}} Seen */

/** @type {Step[]} */
export const STEPS = ["enable", "press", "watch", "let_go", "stop", "reach"];

/** The tool has to move so far to be seen moving, m. */
const SEEN_M = 0.03;
/** The tool has reached a food within this, m. */
const REACH_M = 0.1;
/** Where there is nothing to reach, so far is far enough, m. */
const FAR_M = 0.15;

export class Practice {
  done = 0;
  /** @type {number[] | null} Where the tool was when the step began. */
  _from = null;

  /** The step to do, or null when all are done. @returns {Step | null} */
  get step() {
    return STEPS[this.done] ?? null;
  }

  /** @param {Seen} seen @returns {boolean} whether a step has been done by it */
  see(seen) {
    this._from ??= seen.tool;
    if (!this._doneBy(seen)) return false;
    this._next();
    return true;
  }

  /** The person has pressed Stop, while the arm was enabled. @returns {boolean} whether that was asked for */
  stopped() {
    if (this.step !== "stop") return false;
    this._next();
    return true;
  }

  _next() {
    this.done += 1;
    this._from = null;
  }

  /** @param {Seen} seen */
  _doneBy({ engaged, moving, pressed, tool, goals }) {
    switch (this.step) {
      case "enable": return engaged;
      case "press": return engaged && moving && pressed;
      case "watch": return moving && distance(tool, this._from ?? tool) >= SEEN_M;
      case "let_go": return engaged && !moving && !pressed;
      case "reach": {
        if (goals.length) return goals.some((goal) => distance(tool, goal) <= REACH_M);
        return distance(tool, this._from ?? tool) >= FAR_M;
      }
      default: return false;
    }
  }
}
