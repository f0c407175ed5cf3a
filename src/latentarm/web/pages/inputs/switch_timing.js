/**
 * One switch as its person's hand needs it: a press counts once it has been held long enough, nothing counts for a
 * while after a release, and holding repeats.
 */

/**
 * @typedef {object} Times all in s
 * @property {number} acceptS how long a press must be held before it counts
 * @property {number} releaseS for how long nothing counts after a release
 * @property {number} repeatS how often a press that is held counts again; 0 for never
 */
/** @typedef {{pressed: () => void, released: () => void, repeated: () => void}} Meanings */

export class SwitchTiming {
  /** @param {() => Times} times @param {Meanings} means */
  constructor(times, means) {
    this._times = times;
    this._means = means;
    this._down = false;
    this._accepted = false;
    this._deafUntil = -Infinity;
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    this._timer = undefined;
  }

  /** Whether a press that begins now would be heard. */
  get hears() {
    return !this._down && performance.now() >= this._deafUntil;
  }

  /** Whether a press that counts is under way. */
  get held() {
    return this._accepted;
  }

  /** The switch goes down. @param {boolean} [atOnce] counts without being held: what ends a motion must not wait */
  down(atOnce = false) {
    if (!this.hears) return;
    this._down = true;
    const { acceptS } = this._times();
    if (acceptS === 0 || atOnce) this._accept();
    else this._timer = setTimeout(() => this._accept(), 1000 * acceptS);
  }

  /** The switch comes up, which counts at once. */
  up() {
    if (!this._down) return;
    const accepted = this._accepted;
    this.forget();
    if (!accepted) return;
    this._deafUntil = performance.now() + 1000 * this._times().releaseS;
    this._means.released();
  }

  /** A press under way comes to nothing, as when the page has lost the focus. */
  forget() {
    clearTimeout(this._timer);
    this._down = this._accepted = false;
  }

  _accept() {
    this._accepted = true;
    this._repeatLater();
    this._means.pressed();
  }

  _repeatLater() {
    const { repeatS } = this._times();
    if (repeatS === 0) return;
    this._timer = setTimeout(() => {
      this._repeatLater();
      this._means.repeated();
    }, 1000 * repeatS);
  }
}
