/**
 * Scanning with one or two switches: choices light up, and one of them is taken. A direction moves the arm.
 *
 * How the light goes on: by itself (`auto`), while the switch is held (`inverse`, and letting go takes the choice), with
 * each press (`step`, and waiting takes the choice), or with a second switch. How a direction moves: until the next press
 * (`latch`), or while the switch is held (`hold`).
 */

import { DIRECTIONS } from "./deflection.js";
import { inRows } from "./rows.js";
import { REACTION_MS, SwitchTiming } from "./switch_timing.js";

/** After a motion that ended by itself, a press is still meant for the motion, ms. */
const LATE_PRESS_MS = 800;
/** A direction that waits to be held is forgotten after this long, ms. */
const READY_MS = 6000;

/**
 * @typedef {object} Choice what is called like a direction moves
 * @property {string} id
 * @property {string} label
 * @property {() => void} [act]
 * @property {() => Choice[]} [inner] what it opens
 * @property {boolean} [back] leads back to where it was opened from
 * @property {boolean} [first] the light begins there
 * @property {Choice[]} [row] several that it stands for
 * @property {boolean} [stays] is one of several small changes: the light stays there
 */
/** @typedef {(id: string, label: string, inner: () => Choice[]) => Choice} Group makes a choice that opens others */

/** Events: "change" when other choices are offered, or another one is lit or moves; "switch" when one is pressed or let go, counting or not. */
export class Scanner extends EventTarget {
  /** @param {PersonInput} input @param {Settings} settings */
  constructor(input, settings) {
    super();
    this._input = input;
    this._settings = settings;
    /** @type {Choice[]} What there is to choose from now. */
    this.choices = [];
    /** Index of the choice that a press takes. */
    this.lit = 0;
    /** @type {string | null} The direction that the arm moves in. */
    this.moving = null;
    /** @type {string | null} The direction that the arm will move in while the switch is held. */
    this.ready = null;
    /** @type {Choice[]} */
    this._offered = [];
    /** Ids of the choices that were opened, the outermost first. @type {string[]} */
    this._path = [];
    this._movedUntil = -Infinity;
    /** The choice that brought the task on when the light began there last. @type {string | undefined} */
    this._led = undefined;
    /** When something was last lit by itself, and what was lit before. */
    this._litAt = -Infinity;
    /** @type {Choice | undefined} */
    this._litBefore = undefined;
    /** Whether the person is going through the choices, where that begins with a press. */
    this._going = false;
    /** Whether the press under way has ended a motion, and means no more. */
    this._spent = false;
    this._timer = 0;
    const times = () => this._settings.values;
    const nothing = () => {};
    this._switches = [
      new SwitchTiming(times, {
        pressed: (downAt) => this._pressed(downAt), released: () => this._released(),
        repeated: () => this.style === "step" && this._going && this.next(),
      }),
      new SwitchTiming(times, { pressed: () => this._next(), released: nothing, repeated: () => this._next() }),
    ];
    input.addEventListener("dropped", () => {
      if (this.moving !== null) this._movedUntil = performance.now();
      this._forget();
      this._rest();
    });
    settings.addEventListener("change", () => this._restart());
    window.addEventListener("blur", () => this._forget());
  }

  get on() {
    return this._settings.values.panel === "switch";
  }

  /** How the light goes on. @returns {"two" | "auto" | "inverse" | "step"} */
  get style() {
    const { switches, scan } = this._settings.values;
    return switches === "2" ? "two" : scan;
  }

  /** @param {Choice[]} choices what there is to choose from now; the light starts again where they are others, not where one is only called otherwise */
  offer(choices) {
    this._offered = choices;
    this._show(this._opened());
  }

  next() {
    if (!this.choices.length) return;
    this.lit = (this.lit + 1) % this.choices.length;
    this._changed();
    this._restart();
  }

  /** Take the choice that is lit, or end the motion. */
  choose() {
    if (this.moving !== null) {
      this._rest();
      return;
    }
    const choice = this.choices[this.lit];
    if (!choice) return;
    this._going = false;
    if (choice.id in DIRECTIONS) this._direct(choice.id);
    else if (choice.inner) this._open([...this._path, choice.id]);
    else this._act(choice);
    this._changed();
    this._restart();
  }

  /** A switch goes down or comes up: 0 chooses, 1 goes on; false for other buttons of a gamepad. @param {number} number @param {boolean} down */
  press(number, down) {
    if (!this.on || number >= Number(this._settings.values.switches)) return false;
    this._settings.byHand = false;
    this.dispatchEvent(new CustomEvent("switch", { detail: { number, down } }));
    const one = this._switches[number];
    if (!down) one.up();
    else one.down(this._ends(number));
    return true;
  }

  /** Press a switch for a program that cannot hold it, such as a screen reader. @param {number} number */
  tap(number) {
    this._switches[number].tap(this._ends(number));
  }

  /** A switch was taken away: nothing is chosen by that, and nothing goes on that was held. */
  lost() {
    this._forget();
    if (this.moving !== null && !this._input.latched) this._rest();
  }

  /** Whether a press would end a motion. @param {number} number */
  _ends(number) {
    return number === 0 && this.moving !== null;
  }

  /** @param {number} downAt ms */
  _pressed(downAt) {
    this._spent = this.moving !== null || this._lateMs > 0;
    if (this.moving !== null) this._rest();
    else if (this._spent) return;
    else if (this.ready !== null) this._move(this.ready, false);
    else if (this.style === "auto" || this.style === "two") this._take(downAt);
    else this._go();
  }

  /** Take what is lit, unless nobody can have seen it by then. Stop counts all the same, also where it was lit before. @param {number} at ms */
  _take(at) {
    if (at - this._litAt >= REACTION_MS) this.choose();
    else [this._litBefore, this.choices[this.lit]].find((one) => one?.id === "stop")?.act?.();
  }

  _released() {
    if (this._spent) return;
    if (this.moving !== null && !this._input.latched) this._rest();
    else if (this.style === "inverse" && this._going) this._take(performance.now());
  }

  _next() {
    if (this.moving === null && this._lateMs <= 0) this.next();
  }

  /** The time for which a press still belongs to a motion that has ended by itself, ms. */
  get _lateMs() {
    return this._movedUntil + LATE_PRESS_MS - performance.now();
  }

  /** Begin to go through the choices, or go on, where that takes a press. */
  _go() {
    const goesOn = this._going && this.style === "step";
    this._going = true;
    if (goesOn) this.next();
    else this._restart();
  }

  /** @param {string} direction */
  _direct(direction) {
    const holds = this._settings.values.switchMotion === "hold";
    // A choice that is taken by letting go or by waiting leaves nothing held.
    if (holds && (this.style === "inverse" || this.style === "step")) this.ready = direction;
    // Nor does a click by a screen reader.
    else this._move(direction, !(holds && this._switches[0].held));
  }

  /** @param {string} direction @param {boolean} latched */
  _move(direction, latched) {
    this._input.hold("switch", ...DIRECTIONS[/** @type {Direction} */ (direction)], latched);
    // Another way of pressing may have been first.
    if (this._input.source === "switch") this.moving = direction;
    else this._input.release("switch");
    this.ready = null;
    this._changed();
    this._restart();
  }

  /** @param {Choice} choice */
  _act(choice) {
    if (choice.back) this._open(this._path.slice(0, -1));
    else if (!choice.stays) this._open([]);
    choice.act?.();
  }

  /** @param {string[]} path */
  _open(path) {
    this._path = path;
    this._show(this._opened());
  }

  /** The choices along the path that are still offered. */
  _opened() {
    const listed = (/** @type {Choice[]} */ choices) => (this._settings.values.rows ? inRows(choices) : choices);
    let choices = listed(this._offered);
    for (const [depth, id] of this._path.entries()) {
      const inner = choices.find((choice) => choice.id === id)?.inner;
      if (!inner) {
        this._path = this._path.slice(0, depth);
        break;
      }
      choices = listed(inner());
    }
    return choices;
  }

  /** @param {Choice[]} choices */
  _show(choices) {
    const [ids, before] = [choices, this.choices].map((all) => all.map(({ id }) => id).join());
    const renamed = choices.some(({ label }, index) => label !== this.choices[index]?.label);
    if (ids !== before && before) this._litByItself();
    this.choices = choices;
    if (ids !== before) {
      this.lit = Math.max(this._best, 0);
      this._going = false;
      this.ready = null;
    }
    if (ids !== before || renamed) this._changed();
    if (ids !== before) this._restart();
  }

  /** Index of the choice that brings the task on, or -1. */
  get _best() {
    return this.choices.findIndex(({ first }) => first);
  }

  /** Light the choice that brings the task on, if there is one. */
  _begin(best = this._best) {
    if (best >= 0) {
      this._litByItself();
      this.lit = best;
    }
    this._changed();
    this._restart();
  }

  _litByItself() {
    this._litAt = performance.now();
    this._litBefore = this.choices[this.lit];
  }

  _forget() {
    for (const one of this._switches) one.forget();
    this._going = false;
  }

  _rest() {
    const best = this.moving !== null && this._lateMs <= 0 ? this._best : -1;
    this.moving = this.ready = null;
    this._input.release("switch");
    this._begin(best);
  }

  /** Act when nothing is pressed or let go for a while. */
  _restart() {
    clearTimeout(this._timer);
    const { dwellS, firstS } = this._settings.values;
    if (!this.on || this.moving !== null) return;
    const waitMs = 1000 * (dwellS + (this.lit === Math.max(this._best, 0) ? firstS : 0));
    const goOn = () => {
      this._litByItself();
      if (this._best >= 0 && this.choices[this._best].id !== this._led) this._begin();
      else this.next();
    };
    if (this._lateMs > 0) this._timer = setTimeout(() => this._begin(), this._lateMs);
    else if (this.ready !== null) this._timer = setTimeout(() => this._rest(), READY_MS);
    else if (this.style === "auto") this._timer = setTimeout(goOn, waitMs);
    else if (this.style === "inverse" && this._going) this._timer = setTimeout(goOn, waitMs);
    else if (this.style === "step" && this._going) this._timer = setTimeout(() => this.choose(), waitMs);
  }

  _changed() {
    if (this.lit === this._best) this._led = this.choices[this.lit].id;
    this.dispatchEvent(new Event("change"));
  }
}
