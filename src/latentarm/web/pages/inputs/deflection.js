/** What is pressed, by one source at a time: every way of pressing meets here. */

/** @typedef {import("../connection/messages.js").DriverInput["source"]} Source */
/** @typedef {"up" | "down" | "left" | "right"} Direction */
/** @typedef {"focus_lost" | "page_closed" | "page_hidden" | "pointer_lost" | "gamepad_lost" | "dialog_opened" | "input_changed"} HaltReason */
/** @typedef {import("./drive_input.js").DriveInput | import("../personalise/answer_input.js").AnswerInput | import("./whole_page.js").StillInput} PersonInput */

/** Full deflections: right, up. @type {Record<Direction, [number, number]>} */
export const DIRECTIONS = { up: [0, 1], down: [0, -1], left: [-1, 0], right: [1, 0] };

/** In the order in which people choose. */
export const DIRECTION_NAMES = /** @type {Direction[]} */ (Object.keys(DIRECTIONS));

/** A direction is pressed where its part is at least this share of the larger one. */
const PRESSED_SHARE = 0.4;

/** Events: "turned" when a deflection begins or ends, with its source; "change"; "dropped" when all must let go. */
export class Deflection extends EventTarget {
  constructor() {
    super();
    /** To the right, in [-1, 1]. */
    this.x = 0;
    /** Up, in [-1, 1]. */
    this.y = 0;
    this.latched = false;
    /** @type {Source | null} */
    this.source = null;
  }

  /** The directions that are pressed now. @returns {Direction[]} */
  get pressed() {
    const least = PRESSED_SHARE * Math.max(Math.abs(this.x), Math.abs(this.y));
    return DIRECTION_NAMES.filter((name) => {
      const [x, y] = DIRECTIONS[name];
      return x * this.x + y * this.y > least;
    });
  }

  /**
   * A source is deflected, or back at rest with (0, 0). While one is deflected the others wait.
   *
   * @param {Source} source
   * @param {number} x to the right, in [-1, 1]
   * @param {number} y up, in [-1, 1]
   * @param {boolean} [latched] stays without being held
   */
  hold(source, x, y, latched = false) {
    if (this.source !== null && this.source !== source) return;
    const turned = (this.source === null) !== (x === 0 && y === 0);
    this.x = x;
    this.y = y;
    this.latched = latched;
    this.source = x === 0 && y === 0 ? null : source;
    if (turned) this.dispatchEvent(new CustomEvent("turned", { detail: source }));
    this.dispatchEvent(new Event("change"));
  }

  /** @param {Source} source */
  release(source) {
    if (this.source === source) this.hold(source, 0, 0);
  }

  /** Forget what is pressed; every source hears of it and lets go. */
  neutral() {
    this.x = this.y = 0;
    this.latched = false;
    this.source = null;
    this.dispatchEvent(new Event("dropped"));
    this.dispatchEvent(new Event("change"));
  }
}
