/** How many of the screen's pixels are drawn: fewer where frames take too long, and more again once they have not for long. */

/** Frames may hold others up for so long, ms, less what each frame in time takes back; then there are fewer pixels. */
const MOST_HELD_MS = 320;
const TAKEN_BACK_MS = 16;
const STEP = 0.75;
const LEAST = 0.5;
/** So many frames in time and there are more again; twice as many each time that was too soon. */
const PATIENCE = 200;
const LONGEST_PATIENCE = 3200;

export class PixelShare {
  constructor() {
    /** Of the pixels in each direction, in [0.5, 1]. */
    this.share = 1;
    this._heldMs = this._inTime = 0;
    this._patience = PATIENCE;
  }

  /** A frame was held up by the one before. @param {number} ms @returns {boolean} whether the share is another now */
  held(ms) {
    this._heldMs += ms;
    this._inTime = 0;
    if (this._heldMs <= MOST_HELD_MS || this.share === LEAST) return false;
    this._patience = Math.min(2 * this._patience, LONGEST_PATIENCE);
    return this._become(Math.max(this.share * STEP, LEAST));
  }

  /** A frame was not. @returns {boolean} whether the share is another now */
  inTime() {
    this._heldMs = Math.max(this._heldMs - TAKEN_BACK_MS, 0);
    this._inTime += 1;
    return this.share < 1 && this._inTime > this._patience && this._become(Math.min(this.share / STEP, 1));
  }

  /** @param {number} share */
  _become(share) {
    this.share = share;
    this._heldMs = this._inTime = 0;
    return true;
  }
}
