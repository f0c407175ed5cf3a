/** One camera on the page: its picture, how old that is, and in words why it does not say how things are now. */

import { setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { takenAt } from "./picture_age.js";

/** @import {Dated, ServerClock} from "./picture_age.js" */
/** @typedef {"opening" | "live" | "dark" | "lost"} CameraState */

/** A picture that is older, ms, is greyed. */
export const OLDEST_MS = 300;
/** It is clear again once no picture was older for so long, ms. */
const CLEAR_AFTER_MS = 500;
/** How often the number next to the name changes, ms. */
const NUMBER_MS = 400;

export class CameraView {
  /** @param {HTMLElement} figure @param {ServerClock} clock */
  constructor(figure, clock) {
    this._figure = figure;
    this._clock = clock;
    this._video = /** @type {HTMLVideoElement} */ (figure.querySelector("video"));
    this._age = /** @type {HTMLElement} */ (figure.querySelector(".picture-age"));
    this._says = /** @type {HTMLElement} */ (figure.querySelector(".camera-says"));
    /** @type {CameraState} */
    this.state = "opening";
    /** @type {Dated | null} */
    this.dated = null;
    /** Timestamp of the picture that is shown; undefined where the browser does not tell. @type {number | null | undefined} */
    this._rtp = null;
    this._oldAt = -Infinity;
    this._numberAt = -Infinity;
    const next = () => this._video.requestVideoFrameCallback?.((_, { rtpTimestamp }) => {
      this._rtp = rtpTimestamp;
      next();
    });
    next();
  }

  /** @param {MediaStreamTrack | null} track */
  show(track) {
    this._rtp = this.dated = null;
    this.state = "opening";
    this._video.srcObject = track && new MediaStream([track]);
  }

  /** How old the picture that is shown is now, ms; null where that is not known. @param {number} now */
  ageMs(now) {
    const { aheadMs } = this._clock;
    if (!this.dated || aheadMs === null || typeof this._rtp !== "number") return null;
    return Math.max(0, now + aheadMs - takenAt(this.dated, this._rtp));
  }

  /** Grey what is old, and say what is the matter. @param {number} now @param {boolean} connected */
  look(now, connected) {
    const age = this.ageMs(now);
    // A picture of unknown age is as good as an old one.
    if (age === null || age > OLDEST_MS) this._oldAt = now;
    const old = now - this._oldAt < CLEAR_AFTER_MS;
    const shown = String(old);
    if (this._figure.dataset.old !== shown) this._figure.dataset.old = shown;
    setText(this._says, this._words(old, age, connected));
    if (now - this._numberAt < NUMBER_MS) return;
    this._numberAt = now;
    setText(this._age, age === null ? "" : say("cameras.age", { value: Math.round(age) }));
  }

  /** @param {boolean} old @param {number | null} age @param {boolean} connected */
  _words(old, age, connected) {
    if (!connected || this.state === "opening") return say("cameras.opening");
    if (this.state === "lost") return say("cameras.lost");
    if (this._rtp === null) return say("cameras.opening");
    const doubt = age === null ? say("cameras.age_unknown") : old ? say("cameras.old") : "";
    return this.state === "dark" ? `${say("cameras.dark")} ${doubt}`.trim() : doubt;
  }
}
