/**
 * Scanning with one or two switches: choices light up in turn, a press chooses. A direction moves until the next press.
 *
 * With one switch the light goes on by itself; with two, the second switch moves it on.
 */

import { DIRECTIONS } from "./deflection.js";

/** @import {Direction, PersonInput} from "./deflection.js" */
/** @import {Settings} from "../settings/settings.js" */

/** After a motion that ended by itself, a press is still meant for the motion, ms. */
const LATE_PRESS_MS = 800;

/** @typedef {{id: string, label: string, act?: () => void}} Choice what is called like a direction moves */

/** Event "change" when other choices are offered, or another one is lit or moves. */
export class Scanner extends EventTarget {
  /**
   * @param {PersonInput} input
   * @param {Settings} settings
   */
  constructor(input, settings) {
    super();
    this._input = input;
    this._settings = settings;
    /** @type {Choice[]} */
    this.choices = [];
    /** Index of the choice that a press takes. */
    this.lit = 0;
    /** @type {string | null} The direction that the arm moves in. */
    this.moving = null;
    this._movedUntil = -Infinity;
    /** @type {ReturnType<typeof setInterval> | undefined} */
    this._timer = undefined;
    input.addEventListener("dropped", () => {
      if (this.moving !== null) this._movedUntil = performance.now();
      this._rest();
    });
    settings.addEventListener("change", () => this._restart());
  }

  /** Whether the person steers with switches. */
  get on() {
    return this._settings.values.panel === "switch";
  }

  /** @param {Choice[]} choices what there is to choose from now; the light starts again where they are others, not where one is only called otherwise */
  offer(choices) {
    const [ids, before] = [choices, this.choices].map((all) => all.map(({ id }) => id).join());
    const renamed = choices.some(({ label }, index) => label !== this.choices[index]?.label);
    this.choices = choices;
    if (ids === before) {
      if (renamed) this._changed();
      return;
    }
    this.lit = 0;
    this._changed();
    this._restart();
  }

  /** Light the next choice. */
  next() {
    if (!this.choices.length) return;
    this.lit = (this.lit + 1) % this.choices.length;
    this._changed();
  }

  /** Take the choice that is lit, or end the motion. */
  choose() {
    if (this.moving !== null) {
      this._rest();
      return;
    }
    if (performance.now() - this._movedUntil < LATE_PRESS_MS) return;
    const choice = this.choices[this.lit];
    if (!choice) return;
    const direction = DIRECTIONS[/** @type {Direction} */ (choice.id)];
    if (direction) {
      this._input.hold("switch", ...direction, true);
      // Another way of pressing may have been first.
      if (this._input.source === "switch") this.moving = choice.id;
    } else {
      choice.act?.();
    }
    this._changed();
    this._restart();
  }

  /** A gamepad's button as a switch: the first chooses, the second goes on. @param {number} number @param {boolean} down */
  press(number, down) {
    if (!this.on || number >= Number(this._settings.values.switches)) return false;
    if (down && number === 0) this.choose();
    else if (down) this.next();
    return true;
  }

  _rest() {
    this.moving = null;
    this._input.release("switch");
    this._changed();
    this._restart();
  }

  _restart() {
    clearInterval(this._timer);
    if (this.on && this._settings.values.switches === "1" && this.moving === null) {
      this._timer = setInterval(() => this.next(), this._settings.values.dwellS * 1000);
    }
  }

  _changed() {
    this.dispatchEvent(new Event("change"));
  }
}
