/** The deflection, by one source at a time: every way of pressing meets here. */

/** @typedef {import("../connection/messages.js").DriverInput["source"]} Source */
/** @typedef {"up" | "down" | "left" | "right"} Direction */
/** @typedef {"focus_lost" | "page_closed" | "page_hidden" | "pointer_lost" | "gamepad_lost" | "dialog_opened" | "picture_lost" | "input_changed" | "switch_chatters"} HaltReason */
/** @typedef {import("./drive_input.js").DriveInput | import("../personalise/answer_input.js").AnswerInput | (Deflection & {live: boolean, flowing: boolean, halt: () => void})} PersonInput */

/** Full deflections: right, up. @type {Record<Direction, [number, number]>} */
export const DIRECTIONS = { up: [0, 1], down: [0, -1], left: [-1, 0], right: [1, 0] };

/** In the order in which people choose. */
export const DIRECTION_NAMES = /** @type {Direction[]} */ (Object.keys(DIRECTIONS));

/** A direction is pressed where its part is at least this share of the larger one. */
const PRESSED_SHARE = 0.4;

/** Events: "turned" when a deflection begins or ends, with its source; "change"; "dropped" when all must let go. */
export class Deflection extends EventTarget {
  /** To the right, in [-1, 1]. */
  x = 0;
  /** Up, in [-1, 1]. */
  y = 0;
  /** Stays without being held. */
  latched = false;
  /** @type {Source | null} */
  source = null;
  /** Which one of several of that kind. */
  device = 0;
  /** As the browser calls it: a gamepad by its id, a pointer by its kind. */
  name = "";
  /** Devices that count for nothing until they were let go. @type {Set<string>} */
  _waiting = new Set();

  /** The directions that are pressed now. @returns {Direction[]} */
  get pressed() {
    const least = PRESSED_SHARE * Math.max(Math.abs(this.x), Math.abs(this.y));
    return DIRECTION_NAMES.filter((name) => {
      const [x, y] = DIRECTIONS[name];
      return x * this.x + y * this.y > least;
    });
  }

  /**
   * A device is deflected, or back at rest with (0, 0). While one is deflected the others wait, and a device that was
   * deflected meanwhile counts only once it was let go. @param {Source} source @param {number} x @param {number} y
   */
  hold(source, x, y, latched = false, device = 0, name = "") {
    const rests = x === 0 && y === 0;
    const holds = this._holds(source, device);
    if (rests) this._waiting.delete(nameOf(source, device));
    else if (this.source !== null && !holds) this._waiting.add(nameOf(source, device));
    if (!holds && (rests || this.source !== null || this.waits(source, device))) return;
    const turned = holds === rests;
    this.x = x;
    this.y = y;
    this.latched = latched;
    this.source = rests ? null : source;
    this.device = device;
    this.name = name;
    if (turned) this.dispatchEvent(new CustomEvent("turned", { detail: source }));
    this.dispatchEvent(new Event("change"));
  }

  /** @param {Source} source @param {number} [device] */
  release(source, device = 0) {
    this.hold(source, 0, 0, false, device);
  }

  /** Nobody knows since when a device is as it is: it must be let go before it counts. @param {Source} source @param {number} device */
  distrust(source, device) {
    if (this._holds(source, device)) this.release(source, device);
    this._waiting.add(nameOf(source, device));
  }

  /** Whether a device must be let go before it counts. @param {Source} source @param {number} device */
  waits(source, device) {
    return this._waiting.has(nameOf(source, device));
  }

  /** Forget what is pressed; every source hears of it and lets go. */
  neutral() {
    this.x = this.y = 0;
    this.latched = false;
    this.source = null;
    this._waiting.clear();
    this.dispatchEvent(new Event("dropped"));
    this.dispatchEvent(new Event("change"));
  }

  /** @param {Source} source @param {number} device */
  _holds(source, device) {
    return this.source === source && this.device === device;
  }
}

/** @param {Source} source @param {number} device */
function nameOf(source, device) {
  return `${source} ${device}`;
}
