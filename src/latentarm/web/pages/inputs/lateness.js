/**
 * Whether this page keeps up, measured by how far apart its inputs go out, and how much it may draw.
 *
 * The arm stops where inputs stay away for too long. Before it must, the page draws less: late inputs double the time
 * between two frames, and each second in time takes some of it back.
 */

/** Inputs are due every 20 ms; those farther apart than this are late, ms. */
const LATE_MS = 45;
/** So far apart they may have stopped the arm, ms. */
const TOO_LATE_MS = 80;
/** For so long one knows of it, ms: the server's answer takes its time. */
const KNOWN_MS = 1500;
const FIRST_GAP_MS = 80;
const LONGEST_GAP_MS = 400;
const EASE_AFTER_MS = 1000;
const EASE = 0.85;

export class Lateness {
  _beatAt = -Infinity;
  _lateAt = -Infinity;
  _easedAt = -Infinity;
  _tooLateAt = -Infinity;
  /** The least time between two frames, ms; 0 where the page keeps up. */
  frameGapMs = 0;

  beat() {
    const now = performance.now();
    const apart = now - this._beatAt;
    // The first one after a rest is late for nobody.
    if (Number.isFinite(apart)) this._judge(apart, now);
    this._beatAt = now;
  }

  rest() {
    this._judgeLast();
    this._beatAt = -Infinity;
  }

  /** Whether this page, rather than the network, has held inputs back a moment ago. */
  get wasSlow() {
    this._judgeLast();
    return performance.now() - this._tooLateAt < KNOWN_MS;
  }

  /** The gap that has not ended yet. */
  _judgeLast() {
    const now = performance.now();
    if (now - this._beatAt > TOO_LATE_MS && Number.isFinite(this._beatAt)) this._tooLateAt = now;
  }

  /** @param {number} apart ms @param {number} now ms */
  _judge(apart, now) {
    if (apart > TOO_LATE_MS) this._tooLateAt = now;
    if (apart > LATE_MS) {
      // One hitch is one hitch, however many inputs it held up.
      if (now - this._lateAt > LATE_MS) this.frameGapMs = Math.min(Math.max(2 * this.frameGapMs, FIRST_GAP_MS), LONGEST_GAP_MS);
      this._lateAt = this._easedAt = now;
    } else if (this.frameGapMs && now - this._easedAt > EASE_AFTER_MS) {
      this._easedAt = now;
      this.frameGapMs *= EASE;
      if (this.frameGapMs < FIRST_GAP_MS / 2) this.frameGapMs = 0;
    }
  }
}
