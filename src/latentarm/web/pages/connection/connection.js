/**
 * The page's connection to the server: one WebSocket, JSON both ways, opened again when it breaks.
 *
 * Events: "open" when it has opened or closed; "welcome", "state", "learning", "poses" and "refused" when such a message has
 * come; "run_changed" when another run is driven from now on; "server_changed" when the server was started again. What they
 * carry is in `detail`.
 */

import { OwnPages } from "./own_pages.js";

/** @import {DriverInput, Poses, ServerMessage} from "./messages.js" */

/** How old the newest state may be before inputs are held back, ms: the server would not take them anyway. */
const STALE_MS = 200;
const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 8000;

export class Connection extends EventTarget {
  /** @param {import("../settings/settings.js").Person | null} person who sits here; null for a guest. */
  constructor(person) {
    super();
    this.person = person;
    /** @type {Welcome | null} What is driven. */
    this.welcome = null;
    /** @type {State | null} The newest. */
    this.state = null;
    /** @type {LearningState | null} What is learned, tried and kept. */
    this.learning = null;
    /** @type {Poses | null} The saved poses of who sits here. */
    this.poses = null;
    this.open = false;
    /** @type {boolean | null} Whether this page drove when it last heard of the arm; null before. */
    this.drove = null;
    this.own = new OwnPages();
    this._sequence = 0;
    this._heardAt = -Infinity;
    this._waitMs = FIRST_WAIT_MS;
    this._socket = this._connect();
  }

  /** Whether the newest state is fresh enough that an input which echoes it would count. */
  get fresh() {
    return this.open && this.state !== null && performance.now() - this._heardAt < STALE_MS;
  }

  get silenceMs() {
    return performance.now() - this._heardAt;
  }

  get driving() {
    return this.open && this.state !== null && this.state.you;
  }

  /** Whether the arm is enabled, as far as this page knows. */
  get engaged() {
    return this.open && this.state !== null && ["ready", "moving"].includes(this.state.phase);
  }

  /** @param {ClientMessage} message @returns {boolean} whether it went out. */
  send(message) {
    if (!this.open || this._socket.readyState !== WebSocket.OPEN) return false;
    this._socket.send(JSON.stringify(message));
    return true;
  }

  /**
   * An input, stamped with the newest nonce and a growing number; whether it went out.
   *
   * @param {number[]} u in [-1, 1]
   * @param {Pick<DriverInput, "source" | "device" | "raw" | "latched">} held what it comes from
   * @param {"open" | "close" | "toggle" | null} [gripper] what is asked of the gripper
   * @param {boolean} [opens] whether what opens the gripper of an arm that is not enabled is held down
   */
  sendInput(u, held, gripper = null, opens = false) {
    if (!this.fresh || !this.state) return false;
    this._sequence += 1;
    return this.send({ type: "input", seq: this._sequence, nonce: this.state.nonce, u, ...held, gripper, opens });
  }

  /** Another person sits here now: another page to the server. @param {import("../settings/settings.js").Person | null} person */
  become(person) {
    this.person = person;
    this._socket.close();
  }

  _connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/drive`);
    socket.addEventListener("open", () => {
      this.open = true;
      this._sequence = 0;
      this._waitMs = FIRST_WAIT_MS;
      this._heardAt = performance.now();
      const { person } = this;
      this.send(person ? { type: "hello", version: 1, name: person.name, person: person.id } : { type: "hello", version: 1 });
      this._tell("open", true);
    });
    socket.addEventListener("message", (event) => this._heard(JSON.parse(event.data)));
    socket.addEventListener("close", () => this._lost());
    return socket;
  }

  /** @param {ServerMessage} message */
  _heard(message) {
    this._heardAt = performance.now();
    switch (message.type) {
      case "welcome": {
        const before = this.welcome;
        this.welcome = message;
        this.own.add(message.id);
        if (before !== null && before.server !== message.server) this._tell("server_changed", message.server);
        else if (before !== null && before.run !== message.run) this._tell("run_changed", message.run);
        break;
      }
      case "poses":
        this.poses = message;
        break;
      case "learning":
        this.learning = message;
        break;
      case "state":
        // Ghosts and things are left out while they have not changed.
        this.state = {
          ...message,
          ghosts: message.ghosts ?? this.state?.ghosts ?? null,
          things: message.things ?? this.state?.things ?? null,
        };
        this.drove = message.you;
        break;
      default:
    }
    this._tell(message.type, message);
  }

  _lost() {
    const was = this.open;
    this.open = false;
    this.state = null;
    if (was) this._tell("open", false);
    setTimeout(() => {
      this._socket = this._connect();
    }, this._waitMs);
    this._waitMs = Math.min(2 * this._waitMs, LONGEST_WAIT_MS);
  }

  /** @param {string} type @param {unknown} detail */
  _tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
