/** The stick as an answer: nothing is sent while it is pushed, and the push that was meant stays as a dot. */

import { Deflection } from "../inputs/deflection.js";

const PERIOD_MS = 20;
/** A push that hardly moves for so long is meant, ms: a stick that springs back passes many places. */
const STEADY_MS = 250;
const STEADY = 0.1;

/** Event "answer" when the dot has moved. */
export class AnswerInput extends Deflection {
  constructor() {
    super();
    /** Whether there is a question to answer: only then is anything sampled. */
    this.live = false;
    /** @type {[number, number] | null} The push that was meant. */
    this.answer = null;
    /** @type {{x: number, y: number, at: number}[]} Of this push. */
    this._samples = [];
    this._steady = false;
    setInterval(() => {
      if (!this.live || document.hidden) return;
      this.dispatchEvent(new Event("poll"));
      this._sample();
    }, PERIOD_MS);
    this.addEventListener("change", () => this._sample());
    window.addEventListener("blur", () => this.neutral());
  }

  /** While there is a question, the arrow keys are the stick's. */
  get flowing() {
    return this.live;
  }

  /** A new question: no answer yet, and nothing pressed that was meant for the one before. */
  begin() {
    this.neutral();
    this.live = true;
    this._mean(null);
  }

  end() {
    this.live = false;
    this._mean(null);
    this.neutral();
  }

  /** A pointer or a gamepad was taken away: the dot stays. */
  halt() {
    this.neutral();
  }

  _sample() {
    if (!this.live) return;
    if (this.source === null) {
      this._letGo();
      return;
    }
    const now = performance.now();
    this._samples.push({ x: this.x, y: this.y, at: now });
    // A pointer is let go where it was; it does not spring back.
    const recent = this._samples.filter(({ at }) => now - at < STEADY_MS);
    const steady = this._samples[0].at <= now - STEADY_MS && recent.every(({ x, y }) => Math.hypot(x - this.x, y - this.y) < STEADY);
    if (this.source !== "pointer" && !steady) return;
    this._steady = true;
    this._mean([this.x, this.y]);
  }

  /** A push too short to be steady counts as far as it went. */
  _letGo() {
    if (this._samples.length && !this._steady) {
      const { x, y } = this._samples.reduce((most, one) => (Math.hypot(one.x, one.y) >= Math.hypot(most.x, most.y) ? one : most));
      this._mean([x, y]);
    }
    this._samples = [];
    this._steady = false;
  }

  /** @param {[number, number] | null} answer */
  _mean(answer) {
    if (answer?.join() === this.answer?.join()) return;
    this.answer = answer;
    this.dispatchEvent(new Event("answer"));
  }
}
