/**
 * The page's line to the server: one WebSocket, JSON both ways, reconnected when it breaks.
 *
 * Events: "welcome", "otherrun" (another run is driven from now on), "workshop", "state", "line" (open or not), "refused"; each carries the message or the truth in `detail`.
 */

/** How old the newest state may be before inputs are held back, ms: the server would not take them anyway. */
const STALE_MS = 200;
const LONGEST_WAIT_MS = 8000;

export class Connection extends EventTarget {
  /** @param {string} name what other people see; empty for nobody in particular. */
  constructor(name) {
    super();
    this.name = name;
    /** @type {any} What the server said of itself. */
    this.welcome = null;
    /** @type {any} The newest state. */
    this.state = null;
    /** @type {any} What is learned, tried and kept. */
    this.workshop = null;
    this.open = false;
    this._sequence = 0;
    this._heardAt = -Infinity;
    this._waitMs = 500;
    this._connect();
  }

  /** Whether the newest state is fresh enough that an input which echoes it would count. */
  get fresh() {
    return this.open && this.state !== null && performance.now() - this._heardAt < STALE_MS;
  }

  /** Milliseconds since anything was heard. */
  get silenceMs() {
    return performance.now() - this._heardAt;
  }

  /** Whether this page drives. */
  get driving() {
    return this.open && this.state !== null && this.state.you;
  }

  /** Whether the arm is enabled, as far as this page knows. */
  get engaged() {
    return this.open && this.state !== null && ["ready", "moving"].includes(this.state.phase);
  }

  /**
   * @param {string} type
   * @param {object} [fields]
   * @returns {boolean} whether it went out.
   */
  send(type, fields = {}) {
    if (!this.open || this._socket.readyState !== WebSocket.OPEN) return false;
    this._socket.send(JSON.stringify({ type, ...fields }));
    return true;
  }

  /**
   * An input, stamped with the newest nonce and a growing number.
   *
   * @param {number[]} u in [-1, 1]
   * @param {string} source
   * @param {boolean} latched
   */
  sendInput(u, source, latched) {
    if (!this.fresh) return;
    this._sequence += 1;
    this.send("input", { seq: this._sequence, nonce: this.state.nonce, u, source, latched });
  }

  /** Somebody else sits here now: as another page to the server. @param {string} name */
  rename(name) {
    this.name = name;
    this._socket.close();
  }

  _connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this._socket = new WebSocket(`${scheme}://${location.host}/drive`);
    this._socket.addEventListener("open", () => {
      this.open = true;
      this._sequence = 0;
      this._waitMs = 500;
      this._heardAt = performance.now();
      this.send("hello", this.name ? { version: 1, name: this.name } : { version: 1 });
      this._tell("line", true);
    });
    this._socket.addEventListener("message", (event) => this._heard(JSON.parse(event.data)));
    this._socket.addEventListener("close", () => this._lost());
  }

  /** @param {any} message */
  _heard(message) {
    this._heardAt = performance.now();
    if (message.type === "welcome") {
      const before = this.welcome;
      this.welcome = message;
      if (before !== null && before.run !== message.run) this._tell("otherrun", message.run);
    }
    if (message.type === "workshop") this.workshop = message;
    // Ghosts are left out while they have not changed.
    if (message.type === "state") {
      this.state = { ...message, ghosts: message.ghosts ?? this.state?.ghosts ?? null };
      this._tell("state", this.state);
      return;
    }
    this._tell(message.type, message);
  }

  _lost() {
    const was = this.open;
    this.open = false;
    this.state = null;
    if (was) this._tell("line", false);
    setTimeout(() => this._connect(), this._waitMs);
    this._waitMs = Math.min(2 * this._waitMs, LONGEST_WAIT_MS);
  }

  /** @param {string} type @param {any} detail */
  _tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
