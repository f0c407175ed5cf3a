/**
 * One switch as its person's hand needs it: a press counts once it has been held long enough, nothing counts until the
 * switch has been left alone for a while, and holding repeats.
 */

/** @typedef {{pressed: (downAt: number) => void, released: () => void, repeated: () => void}} Meanings `downAt` is when it went down, ms */

/**
 * Nobody answers what they see sooner, ms. Simple reactions to a light take a mean of 231 ms on a computer, of 1469 people
 * (Woods, Wyma, Yund, Herron and Reed, Frontiers in Human Neuroscience 9:131, 2015); to choose takes longer.
 */
export const REACTION_MS = 200;
/** Contacts bounce for 1.6 ms on average, and nearly all for less than this, ms (Ganssle, A Guide to Debouncing, 2008). */
const BOUNCE_MS = 10;
/** Adapters that repeat while they are held press again within this, ms. No tremor does: 8 Hz at most. */
const REPEATED_MS = 105;
/** From this repetition on it is one press that is held. */
const REPETITIONS = 2;

export class SwitchTiming {
  /** @param {() => Pick<Values, "acceptS" | "releaseS" | "repeatS">} times @param {Meanings} means */
  constructor(times, means) {
    this._times = times;
    this._means = means;
    this._down = false;
    this._accepted = false;
    this._downAt = this._upAt = this._heldSince = -Infinity;
    this._repetitions = 0;
    /** True once the press that repeats has counted, or came too early to count. */
    this._spent = false;
    this._timer = 0;
  }

  /** Whether a press that counts is under way. */
  get held() {
    return this._accepted;
  }

  /** The switch goes down. @param {boolean} [ends] ends a motion, which counts always and at once */
  down(ends = false) {
    const now = performance.now();
    if (this._down || now - this._upAt < BOUNCE_MS) return;
    this._down = true;
    if (now - this._downAt < REPEATED_MS) this._repetitions += 1;
    else [this._heldSince, this._repetitions, this._spent] = [now, 0, false];
    this._downAt = now;
    const { acceptS, releaseS } = this._times();
    const waitMs = 1000 * acceptS - (this._repetitions < REPETITIONS ? 0 : now - this._heldSince);
    const early = now - this._upAt < 1000 * releaseS && (this._repetitions === 0 || this._spent);
    if (ends) this._accept();
    else if (early) [this._upAt, this._spent] = [now, true];
    else if (waitMs <= 0) this._accept();
    else this._timer = setTimeout(() => this._accept(), waitMs);
  }

  /** The switch comes up, which counts at once. */
  up() {
    if (!this._down) return;
    const accepted = this._accepted;
    this.forget();
    const now = performance.now();
    if (accepted || now - this._downAt >= BOUNCE_MS) this._upAt = now;
    if (accepted) this._means.released();
  }

  /** It was pressed by something that cannot hold it. @param {boolean} ends see `down` */
  tap(ends) {
    this.down(ends);
    if (this._timer !== 0 && !this._accepted) {
      clearTimeout(this._timer);
      this._accept();
    }
    this.up();
  }

  /** A press under way comes to nothing, as when the page has lost the focus. */
  forget() {
    clearTimeout(this._timer);
    this._timer = 0;
    this._down = this._accepted = false;
  }

  _accept() {
    this._accepted = this._spent = true;
    this._repeatLater();
    this._means.pressed(this._downAt);
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
