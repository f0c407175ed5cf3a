/** How old a picture is: the time at the server, and the moment that a timestamp of a stream means. */

/** Answers are believed for so many questions; of these the quickest says most. */
const KEPT = 12;
/** Steps of the clock of a video stream in a millisecond. */
const STEPS_PER_MS = 90;

/** Dates a stream's timestamp: the picture `rtp` was taken at `at`, ms on the server's clock. @typedef {{rtp: number, at: number}} Dated */

/** The server's clock, as far as this page can tell: within half the time that the quickest answer took. */
export class ServerClock {
  constructor() {
    /** @type {{tookMs: number, aheadMs: number}[]} */
    this._answers = [];
  }

  /** All in ms. @param {number} sent when the question went out @param {number} received when the answer came @param {number} server what time it was there */
  answered(sent, received, server) {
    if (!(received >= sent)) return;
    this._answers.push({ tookMs: received - sent, aheadMs: server - (sent + received) / 2 });
    if (this._answers.length > KEPT) this._answers.shift();
  }

  /** By how much the server's clock is ahead of this page's, ms; null while nothing is known. */
  get aheadMs() {
    if (!this._answers.length) return null;
    return this._answers.reduce((best, one) => (one.tookMs < best.tookMs ? one : best)).aheadMs;
  }
}

/** When the picture with a timestamp was taken, ms on the server's clock: timestamps wrap around. @param {Dated} dated @param {number} rtp */
export function takenAt({ rtp: known, at }, rtp) {
  return at + ((rtp - known) | 0) / STEPS_PER_MS;
}
