/** Exercises of a hand, in which nothing moves. Of each `share` is how much is done, in [0, 1]; times are in s. */

import { DIRECTIONS } from "../inputs/deflection.js";
import { driftOf } from "./measures.js";

/** @import {Sample} from "./measures.js" */

const [REST_S, PUSH_S] = [6, 3];
/** A page that hung has seen nothing: what is held begins anew. */
const GAP_S = 0.15;
/** A push is at least so far, and by so much further than the hand strays. */
const [BEGUN, BEYOND] = [0.15, 0.05];
/** What is named, of four cells: never the first, which is lit already, or the last, so that a press can be late. */
const NAMED = [2, 1, 2, 2, 1, 2, 1, 1];
export const CELLS = ["1", "2", "3", "4"];
/** A second press within this was not meant. */
const DOUBLE_S = 0.5;

/** Hold the stick in a direction, or keep still at `rest`, which is then null. */
export class Hold {
  /** @param {Direction | null} towards @param {Hold | null} rest by how far the hand strays it is known what is no push */
  constructor(towards, rest) {
    this.towards = towards;
    this._rest = rest;
    /** @type {Sample[]} */
    this.samples = [];
  }

  /** @param {readonly number[] | null} push null where no hand is on the stick @param {number} now */
  see(push, now) {
    const isKept = push?.every(Number.isFinite) && this._counts(push) && now - (this.samples.at(-1)?.[2] ?? now) < GAP_S;
    this.samples = push && isKept ? [...this.samples, [push[0], push[1], now]] : [];
  }

  get share() {
    const lasts = (this.samples.at(-1)?.[2] ?? 0) - (this.samples[0]?.[2] ?? 0);
    return Math.min(lasts / (this.towards ? PUSH_S : REST_S), 1);
  }

  /** @param {readonly number[]} push */
  _counts([x, y]) {
    const [right, up] = this.towards ? DIRECTIONS[this.towards] : [0, 0];
    const along = right * x + up * y;
    return !this._rest || along >= Math.max(BEGUN, (driftOf(this._rest.samples) || 0) + BEYOND, Math.abs(right * y + up * x));
  }
}

/** Choose the named cell with a switch, some times. */
export class Trials {
  done = 0;
  /** How often the named cell was chosen, one before it, or one after it. */
  counts = { right: 0, early: 0, late: 0 };
  /** From when the named cell was lit to the press that is to take it; where waiting chooses, from press to press. @type {number[]} */
  reactions = [];
  /** @type {number[]} */
  holds = [];
  /** From letting go to a press too many. @type {number[]} */
  doubles = [];
  _litAt = NaN;
  _downAt = -Infinity;
  _upAt = -Infinity;

  /** @param {import("../inputs/scanner.js").Scanner["style"]} style how the light goes on */
  constructor(style) {
    this._style = style;
  }

  get share() {
    return this.done / NAMED.length;
  }

  get named() {
    return CELLS[NAMED[this.done] ?? 0];
  }

  /** Another cell is lit. @param {number} index @param {number} now */
  lit(index, now) {
    if (index === NAMED[this.done] && this._style !== "step") this._litAt = now;
  }

  /** The switch that chooses goes down or comes up. @param {boolean} down @param {number} now */
  pressed(down, now) {
    const isDouble = down && now - this._upAt < DOUBLE_S && this._style !== "step";
    if (isDouble) this.doubles.push(now - this._upAt);
    // Two switches have all the time.
    else if (down !== (this._style === "inverse") && this._style !== "two") {
      if (now >= this._litAt) this.reactions.push(now - this._litAt);
      this._litAt = this._style === "step" ? now : NaN;
    }
    if (down) this._downAt = now;
    else [this._upAt, this.holds] = [now, [...this.holds, now - this._downAt]];
  }

  /** A cell was taken, or Stop, which comes after them. @param {number} index */
  took(index) {
    const off = Math.sign(index - NAMED[this.done]);
    this.counts[off === 0 ? "right" : off < 0 ? "early" : "late"] += 1;
    this.done += 1;
    this._litAt = NaN;
  }
}
