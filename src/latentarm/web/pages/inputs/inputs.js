/**
 * Where every way of pressing meets: one at a time, shaped for the person, and sent while the page can be trusted.
 *
 * Inputs flow from Enable on until the arm is disengaged. Whatever makes the page doubtful (focus lost, hidden,
 * closed, a pointer or a gamepad taken away) sends neutral and a stop, and then nothing until Enable is pressed.
 */

import { Held } from "./held.js";

const PERIOD_MS = 20;
/** Neutral inputs that go ahead of `enable`, ms: the server must have seen the stick at rest. */
const NEUTRAL_FIRST_MS = 60;
/** How long an unanswered Enable keeps sending, ms. */
const PATIENCE_MS = 1500;

/** @typedef {import("./held.js").Source} Source */

export class Inputs extends Held {
  /**
   * @param {import("../connection/connection.js").Connection} connection
   * @param {(x: number, y: number) => number[]} shaped from stick (right, up) to what is sent
   */
  constructor(connection, shaped) {
    super();
    this._connection = connection;
    this._shaped = shaped;
    this._timer = this._enabling = 0;
    this._wasEngaged = false;
    this._askedAt = -Infinity;
    this.addEventListener("turned", (event) => this._send(/** @type {CustomEvent} */ (event).detail));
    connection.addEventListener("state", () => this._onState());
    connection.addEventListener("line", () => this.drop());
    window.addEventListener("blur", () => this.halt("this window lost the focus"));
    window.addEventListener("pagehide", () => this.halt("the page was closed"));
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) this.halt("the page was hidden");
    });
  }

  /** Whether inputs are going out. */
  get flowing() {
    return this._timer !== 0;
  }

  /** Whether a press that begins now would move the arm. */
  get live() {
    return this.flowing && this._connection.driving && this._connection.engaged;
  }

  /** The person's explicit action: neutral inputs first, then `enable`. */
  enable() {
    if (document.hidden) return;
    this.dispatchEvent(new CustomEvent("halted", { detail: null }));
    this._askedAt = performance.now();
    this._wasEngaged = false;
    if (!this.flowing) this._timer = setInterval(() => this._tick(), PERIOD_MS);
    this._send(this.source ?? "pointer");
    clearTimeout(this._enabling);
    this._enabling = setTimeout(() => this._connection.send("enable"), NEUTRAL_FIRST_MS);
  }

  /**
   * Neutral, a stop, and then silence until the person enables again. Only a page whose inputs flow stops the arm so.
   *
   * @param {string} why said to the person as "Stopped: …"
   */
  halt(why) {
    const flowed = this.flowing;
    this.drop();
    if (!flowed) return;
    this._connection.send("stop");
    this.dispatchEvent(new CustomEvent("halted", { detail: why }));
  }

  /** Let go of everything, and send no more until the person enables again. */
  drop() {
    this.neutral();
    if (this.flowing) this._send("pointer");
    this._end();
  }

  _end() {
    // An Enable that has not gone out yet must not come after a Stop.
    clearTimeout(this._enabling);
    clearInterval(this._timer);
    this._timer = 0;
  }

  _tick() {
    this.dispatchEvent(new Event("poll"));
    this._send(this.source ?? "pointer");
  }

  /** @param {Source} source */
  _send(source) {
    if (!this.flowing || !this._connection.driving) return;
    this._connection.sendInput(this._shaped(this.x, this.y), source, this.latched);
  }

  _onState() {
    if (!this.flowing) return;
    const engaged = this._connection.engaged;
    const impatient = performance.now() - this._askedAt > PATIENCE_MS;
    if ((this._wasEngaged || impatient) && !engaged) this.drop();
    this._wasEngaged = engaged;
  }
}
