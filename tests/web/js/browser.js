/** As much of a browser as the page's logic needs, under Node: a clock, windows, sockets, storage and elements. */

import { mock } from "node:test";

import english from "../../../src/latentarm/web/words/en.json" with { type: "json" };
import { useWords } from "#pages/layout/words.js";

let now = 0;

/** Let time pass, one millisecond after the other. @param {number} ms */
export function pass(ms) {
  for (let passed = 0; passed < ms; passed += 1) {
    now += 1;
    mock.timers.tick(1);
  }
}

export class FakeSocket extends EventTarget {
  static OPEN = 1;

  /** @type {FakeSocket[]} */
  static all = [];

  constructor(url) {
    super();
    this.url = url;
    this.readyState = 0;
    this.sent = [];
    FakeSocket.all.push(this);
  }

  static get newest() {
    return FakeSocket.all[FakeSocket.all.length - 1];
  }

  opens() {
    this.readyState = FakeSocket.OPEN;
    this.dispatchEvent(new Event("open"));
  }

  says(message) {
    this.dispatchEvent(Object.assign(new Event("message"), { data: JSON.stringify(message) }));
  }

  send(text) {
    this.sent.push(JSON.parse(text));
  }

  close() {
    this.readyState = 3;
    this.dispatchEvent(new Event("close"));
  }

  /** What was sent since the last look. */
  taken() {
    return this.sent.splice(0);
  }
}

export class FakeElement extends EventTarget {
  /** @param {string} [kinds] selectors that it, or something around it, matches */
  constructor(kinds = "") {
    super();
    this.kinds = kinds.split(" ").filter(Boolean);
    this.dataset = {};
    this.textContent = "";
    this.hidden = false;
    this.children = [];
    this.attributes = new Map();
  }

  append(...children) {
    this.children.push(...children);
  }

  replaceChildren(...children) {
    this.children = children;
  }

  setAttribute(name, value) {
    this.attributes.set(name, value);
  }

  getAttribute(name) {
    return this.attributes.get(name) ?? null;
  }

  removeAttribute(name) {
    this.attributes.delete(name);
  }

  toggleAttribute(name, on) {
    if (on) this.attributes.set(name, "");
    else this.attributes.delete(name);
  }

  matches(selector) {
    return this.kinds.some((kind) => selector.split(/,\s*/).some((part) => part.startsWith(kind)));
  }

  closest(selector) {
    return this.matches(selector) ? this : null;
  }
}

class FakeStorage {
  constructor() {
    this.kept = new Map();
  }

  getItem(key) {
    return this.kept.get(key) ?? null;
  }

  setItem(key, value) {
    this.kept.set(key, value);
  }

  removeItem(key) {
    this.kept.delete(key);
  }
}

/** A new browser for one test. */
export function newBrowser() {
  mock.timers.reset();
  mock.restoreAll();
  mock.timers.enable({ apis: ["setTimeout", "setInterval"] });
  mock.method(performance, "now", () => now);
  FakeSocket.all = [];
  const fakes = {
    window: new EventTarget(),
    document: Object.assign(new EventTarget(), { hidden: false, elements: {}, getElementById(id) { return this.elements[id] ?? null; }, querySelector: () => null, getElementsByTagName: () => [], createElement: () => new FakeElement() }),
    localStorage: new FakeStorage(),
    sessionStorage: new FakeStorage(),
    location: { protocol: "https:", host: "arm.local" },
    WebSocket: FakeSocket,
    Element: FakeElement,
    HTMLElement: FakeElement,
    HTMLButtonElement: FakeElement,
    HTMLDetailsElement: FakeElement,
    HTMLInputElement: FakeElement,
    HTMLSelectElement: FakeElement,
    matchMedia: () => Object.assign(new EventTarget(), { matches: false }),
    fetch: mock.fn(() => Promise.resolve()),
  };
  for (const [name, value] of Object.entries(fakes)) {
    Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
  }
  useWords("en", english);
  return fakes;
}

/** Elements that the page has from now on, by these names. @param {Record<string, string>} ids of each name */
export function elementsOf(ids) {
  const made = Object.fromEntries(Object.keys(ids).map((name) => [name, new FakeElement()]));
  for (const [name, id] of Object.entries(ids)) globalThis.document.elements[id] = made[name];
  return made;
}

/** An event with what a browser would tell of it. @param {string} type @param {object} [fields] */
export function event(type, { target, ...fields } = {}) {
  const made = Object.assign(new Event(type, { cancelable: true }), fields);
  if (target) Object.defineProperty(made, "target", { value: target });
  return made;
}

/** Press or release a key. @param {"keydown" | "keyup"} type @param {string} code @param {object} [fields] */
export function key(type, code, fields = {}) {
  const pressed = event(type, { code, repeat: false, ...fields });
  globalThis.window.dispatchEvent(pressed);
  return pressed;
}

const STATE = {
  type: "state", nonce: "n", tick: 0, phase: "disengaged", note: null, reason: null, held_back: null, zone: null, mode: "latent", axes: 0, help: "off", profile: null, bodies: [], tool: [0, 0, 0],
  gripper: null, held: [], task: { choice: 0, done: 0, outcome: null, why: null, time_s: 0, to_go: null, lost: null, short: false }, things: null, ghosts: null, belief: null, alpha: 0, bound_m: null, driver: null, driver_name: null, watchers: 0, asking: null,
  asking_name: null, returning: false, bound_for: null, guiding: null, lost: false, at_start: false, let_go_first: false, idle_left_s: null, copilot: null, copilot_asking: null, recording: null, trail: 0, late_share: 0, you: false,
};

/** A state as the server says it. @param {object} [fields] */
export function stateOf(fields = {}) {
  return { ...STATE, ...fields };
}

/** What a page with the control knows. @param {object} [fields] */
export function pageOf(fields = {}) {
  return {
    values: { panel: "stick", press: "hold", switchMotion: "latch" }, halted: null, turnedAway: "", canEnable: true, canConnect: true, unconfirmed: false, dialog: false,
    refused: false, pushAgain: false, pressed: false, keys: true, practice: null, next: null, late: "connection", absent: false, ...fields,
  };
}

/** A welcome as the server says it. @param {object} [fields] */
export function welcomeOf(fields = {}) {
  return {
    type: "welcome", version: 1, id: "me", server: "first", dof: 7, latent_dim: 2, robot: "panda", run: "one", profiles: [],
    modes: ["latent", "assisted", "end_effector"], goals: [], end_effector_modes: ["x-y", "z-yaw", "roll-pitch"],
    latch_max_s: 5, gripper_width_m: null, things: [], real: null, poses: [], zones: [], keep_out: [],
    task: { name: "reach", seed: 0, choices: [], choice: 0, steps: [] }, ...fields,
  };
}
