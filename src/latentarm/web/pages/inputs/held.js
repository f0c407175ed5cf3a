/** What is pressed, by one source at a time: every way of pressing meets here. */

/** @typedef {"pointer" | "dpad" | "keyboard" | "gamepad" | "switch"} Source */

/** Events: "turned" when a deflection begins or ends, with its source; "change"; "dropped" when all must let go. */
export class Held extends EventTarget {
  constructor() {
    super();
    this.x = this.y = 0;
    this.latched = false;
    /** @type {Source | null} */
    this.source = null;
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
