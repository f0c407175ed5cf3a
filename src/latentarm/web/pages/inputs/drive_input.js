/**
 * The person's input while they drive: shaped for them, and sent while the page can be trusted.
 *
 * Inputs flow from Enable on until the arm is disengaged. Whatever makes the page doubtful (focus lost, hidden,
 * closed, a pointer or a gamepad taken away) sends neutral and a stop, and then nothing until Enable is pressed.
 */

import { Deflection } from "./deflection.js";
import { Lateness } from "./lateness.js";

/** @typedef {NonNullable<import("../connection/messages.js").DriverInput["gripper"]>} GripperAsk */

const PERIOD_MS = 20;
/** Neutral inputs that go ahead of `enable`, ms: the server must have seen the stick at rest. */
const NEUTRAL_FIRST_MS = 60;
/** How long an unanswered Enable keeps sending, ms. */
const PATIENCE_MS = 1500;

/** Events besides those of `Deflection`: "poll" before each input; "halted" with why this page stopped the arm, or null. */
export class DriveInput extends Deflection {
  /** @param {Connection} connection @param {Shaped} shaped @param {ReturnType<typeof import("./tremor.js").attachTremor>} steady before that */
  constructor(connection, shaped, steady) {
    super();
    this._steady = steady;
    this._connection = connection;
    this._shaped = shaped;
    this._timer = 0;
    this._enabling = 0;
    /** While what opens the gripper is held. */
    this._opening = 0;
    this._wasEngaged = false;
    this._askedAt = -Infinity;
    this._tickedAt = -Infinity;
    this.lateness = new Lateness();
    this.addEventListener("turned", (event) => this._send(/** @type {CustomEvent<Source>} */ (event).detail));
    connection.addEventListener("state", () => this._onState());
    connection.addEventListener("open", () => this.drop());
    window.addEventListener("blur", () => this.halt("focus_lost"));
    window.addEventListener("pagehide", () => this.halt("page_closed"));
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) this.halt("page_hidden");
    });
  }

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
    this._say(null);
    this._askedAt = performance.now();
    this._wasEngaged = false;
    this._timer ||= setInterval(() => this._onTimer(), PERIOD_MS);
    this._send(this.source ?? "pointer");
    clearTimeout(this._enabling);
    this._enabling = setTimeout(() => this._connection.send({ type: "enable" }), NEUTRAL_FIRST_MS);
  }

  /** Neutral, a stop, and then silence until the person enables again. Only a page whose inputs flow stops the arm so. @param {HaltReason} why */
  halt(why) {
    const flowed = this.flowing;
    this.drop();
    if (!flowed) return;
    this._connection.send({ type: "stop", why: "page" });
    this._say(why);
  }

  /** Ask the gripper for something, once; false before the arm is enabled. @param {GripperAsk} gripper @param {Source} source */
  ask(gripper, source) {
    if (!this.live) return false;
    return this._connection.sendInput(this._meant(), this._held(this.source ?? source), gripper);
  }

  /**
   * Open the gripper of an arm that is not enabled, as long as this is held; next to the arm it is judged for how long. False
   * where it cannot be asked for. @param {Source} source @param {() => boolean} held
   */
  holdOpen(source, held) {
    const may = () => !this.flowing && !document.hidden && this._connection.driving && !this._connection.engaged;
    if (!may()) return false;
    clearInterval(this._opening);
    this._opening = setInterval(() => {
      const opens = held() && may();
      this._connection.sendInput(this._shaped(0, 0), { source, latched: false }, null, opens);
      if (!opens) clearInterval(this._opening);
    }, PERIOD_MS);
    return true;
  }

  /** Let go of everything, and send no more until the person enables again. */
  drop() {
    this.neutral();
    if (this.flowing) this._send("pointer");
    // An Enable that has not gone out yet must not come after a Stop.
    clearTimeout(this._enabling);
    clearInterval(this._timer);
    clearInterval(this._opening);
    this._timer = 0;
    this.lateness.rest();
  }

  /** Inputs go first: an input that is due goes out now, before work that would hold it up. */
  goFirst() {
    if (this.flowing && performance.now() - this._tickedAt >= PERIOD_MS) this._tick();
  }

  _onTimer() {
    // The one before may have gone first: the server takes only so many.
    if (performance.now() - this._tickedAt >= PERIOD_MS / 2) this._tick();
  }

  _tick() {
    this._tickedAt = performance.now();
    this.lateness.beat();
    this.dispatchEvent(new Event("poll"));
    this._send(this.source ?? "pointer");
  }

  /** @param {Source} source */
  _send(source) {
    if (!this.flowing || !this._connection.driving) return;
    this._connection.sendInput(this._meant(), this._held(source));
  }

  /** @param {Source} source */
  _held(source) {
    return { source, device: this.device, name: this.name, raw: /** @type {[number, number]} */ ([this.x, this.y]), latched: this.latched };
  }

  _meant() {
    return this._shaped(...this._steady(this.x, this.y, this.source));
  }

  _onState() {
    // After a change of what the stick does, what goes on without being held is let go; what is held, people let go.
    if (this._connection.driving && this._connection.state?.let_go_first && this.latched) this.neutral();
    if (!this.flowing) return;
    this.goFirst();
    const engaged = this._connection.engaged;
    const impatient = performance.now() - this._askedAt > PATIENCE_MS;
    if ((this._wasEngaged || impatient) && !engaged) this.drop();
    this._wasEngaged = engaged;
  }

  /** @param {HaltReason | null} why */
  _say(why) {
    this.dispatchEvent(new CustomEvent("halted", { detail: why }));
  }
}
