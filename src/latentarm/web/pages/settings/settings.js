/** Each person's settings, kept in this browser under their id; `person_sync.js` keeps it on the server as well. */

import { EVERY_STOP, validMappings } from "./pads.js";
import * as storage from "./storage.js";

/** @template T @typedef {{usual: T, valid: (value: any) => T}} Setting its default, and what is made of a value of its type */

/** @template T @param {T} usual @returns {Setting<T>} */
const any = (usual) => ({ usual, valid: (value) => value });
/** @param {number} usual @param {number} least @param {number} most @returns {Setting<number>} */
const within = (usual, least, most) => ({ usual, valid: (value) => Math.min(Math.max(value, least), most) });
/** The first is the default. @template {string} T @param {T[]} all @returns {Setting<T>} */
const oneOf = (...all) => ({ usual: all[0], valid: (value) => (all.includes(value) ? value : all[0]) });

const SETTINGS = {
  profile: any(""), // whose alignment; empty for what the server was started with, `NO_PROFILE` for none
  sensitivity: within(0.5, 0.1, 1), // largest input
  deadZone: within(0.1, 0, 0.5), // pushes smaller than this are ignored
  reach: within(1, 0.4, 1), // how far counts as a full push
  swapAxes: any(false),
  invertX: any(false),
  invertY: any(false),
  press: oneOf("hold", "step", "latch"), // what a press does
  stepS: within(0.5, 0.2, 2), // length of a step, s
  latchS: within(10, 1, 10), // how long a motion goes on without being held, s
  tremor: oneOf("off", "light", "medium", "strong"), // how much a trembling hand is steadied
  help: oneOf("medium", "off", "low", "high"), // how much the robot helps
  panel: oneOf("stick", "dpad", "switch"), // what is pressed
  switches: oneOf("1", "2"), // how many
  scan: oneOf("auto", "inverse", "step"), // how the light goes on with one switch
  switchMotion: oneOf("latch", "hold"), // how a direction moves: until the next press, or while the switch is held
  dwellS: within(1.2, 0.4, 5), // scan interval: how long a choice stays lit, s
  firstS: within(0, 0, 3), // how much longer the first one does, s
  // How long a switch must be held before that counts, s. Of 168,000 people a key press takes 116 ms with an SD of 24
  // (Dhakal et al., CHI 2018): 0.05 s is nearly three below.
  acceptS: within(0.05, 0, 2),
  releaseS: within(0.2, 0, 2), // how long a switch must have been up before a press counts, s
  repeatS: within(0, 0, 3), // how often a switch that is held counts again, s; 0 for never
  rows: any(false), // whether long lists are scanned by rows
  bestFirst: any(true), // whether what brings the task on is lit first, and a motion ends where its way ends
  speak: any(false), // whether what is lit is spoken
  speakNext: any(false), // whether what is to be done now is spoken
  speakVolume: within(0.8, 0, 1),
  switchKey: any("Enter"), // key that chooses
  nextKey: any("Backspace"), // key that goes on
  /** How gamepads are used, by their ids. @type {Setting<Record<string, import("./pads.js").Mapping>>} */
  pads: { usual: {}, valid: validMappings },
  /** What was measured last with each input, and when. @type {Setting<Record<string, Record<string, number>>>} */
  fit: { usual: {}, valid: validMeasures },
  shortcuts: any(true), // whether letters and digits drive
  seat: oneOf("facing", "behind"), // where the person sits
  largeView: oneOf("front", "side"), // which of the two views is the large one
  picture: oneOf("camera", "drawn"), // what is seen of the arm where there are cameras
  showGhosts: any(true),
  showTrail: any(true),
  practised: any(false), // whether the guided practice was begun or skipped
  sounds: oneOf("success", "none", "all"), // what is heard: a task that is done, nothing, or Stop and Enable too
  vibration: any(false), // whether Stop and a task that is done are felt
  theme: oneOf("auto", "light", "dark"),
};
/** @typedef {{[K in keyof typeof SETTINGS]: (typeof SETTINGS)[K]["usual"]}} Values */

export const DEFAULTS = /** @type {Readonly<Values>} */ (Object.fromEntries(Object.entries(SETTINGS).map(([key, { usual }]) => [key, usual])));

/** Instead of a profile's name: no alignment, also where the server was started with one. */
export const NO_PROFILE = "-";

const PERSON_KEY = "latentarm.person";
const SETTINGS_KEY = "latentarm.settings.";
/** The switch that chose the person who sits here: who cannot use a hand must be able to go on, and back. */
const SWITCH_KEY = "latentarm.switch";
const NAMES = Object.keys(SETTINGS);
const OF_SWITCH = NAMES.slice(NAMES.indexOf("panel"), NAMES.indexOf("pads"));
/** Changes of a person's settings that the server may not have yet. */
export const UNSENT_KEY = "latentarm.unsent.";

/** @typedef {{id: string, name: string}} Person */

/** Events: "change" after every change, "edited" after those made here, "person" when somebody else sits down. */
export class Settings extends EventTarget {
  constructor() {
    super();
    /** Who sits here; null for a guest. @type {Person | null} */
    this.person = personIn(storage.read(PERSON_KEY));
    /** True after a hand was used, false after a switch. */
    this.byHand = false;
    this.own = this.values = valid(storage.read(this._key));
    this._use(this.own);
  }

  get name() {
    return this.person?.name ?? "";
  }

  /** Somebody sits down, or a guest: their settings as this browser knows them, or the defaults. @param {Person | null} person */
  become(person) {
    if (this.values.panel !== "switch" || this.byHand) storage.remove(SWITCH_KEY);
    else storage.write(SWITCH_KEY, JSON.stringify(this.values, OF_SWITCH));
    this.person = person;
    if (person) storage.write(PERSON_KEY, JSON.stringify(person));
    else storage.remove(PERSON_KEY);
    // Version 0.1.0 kept settings under people's names.
    this._use(valid(storage.read(this._key) ?? (person && storage.read(SETTINGS_KEY + person.name))));
    this.dispatchEvent(new Event("person"));
    this.dispatchEvent(new Event("change"));
  }

  /** The person is called otherwise now. @param {string} name */
  rename(name) {
    if (!this.person || this.person.name === name) return;
    this.person = { ...this.person, name };
    storage.write(PERSON_KEY, JSON.stringify(this.person));
    this.dispatchEvent(new Event("change"));
  }

  /** Take the server's settings. @param {unknown} values */
  take(values) {
    this._use(valid(JSON.stringify(values)));
    storage.write(this._key, JSON.stringify(this.own));
    this.dispatchEvent(new Event("change"));
  }

  /** @param {Values} own the person's own settings, under those of the switch that chose them until they choose a control */
  _use(own) {
    this.own = own;
    this.values = own.panel === "switch" ? own : valid(JSON.stringify({ ...own, ...storage.parsed(storage.read(SWITCH_KEY)) }));
  }

  /** Nothing of a person stays in this browser. @param {Person} person */
  forget(person) {
    for (const key of [SETTINGS_KEY + person.id, SETTINGS_KEY + person.name, UNSENT_KEY + person.id]) storage.remove(key);
    if (this.person?.id === person.id) this.become(null);
  }

  /** @param {Partial<Values>} changes */
  change(changes) {
    if ("panel" in changes) storage.remove(SWITCH_KEY);
    else if (storage.read(SWITCH_KEY)) storage.write(SWITCH_KEY, JSON.stringify({ ...this.values, ...changes }, OF_SWITCH));
    this._use({ ...this.own, ...changes });
    storage.write(this._key, JSON.stringify(this.own));
    this.dispatchEvent(new Event("edited"));
    this.dispatchEvent(new Event("change"));
  }

  /** The defaults again; what was measured stays, and a switch as it is used. */
  reset() {
    const used = this.values.panel === "switch" ? storage.parsed(JSON.stringify(this.values, OF_SWITCH)) : {};
    this.change({ ...DEFAULTS, ...used, fit: this.values.fit });
  }

  get _key() {
    return SETTINGS_KEY + (this.person?.id ?? "");
  }
}

/** @param {string | null} stored @returns {Person | null} */
function personIn(stored) {
  const person = storage.parsed(stored);
  return typeof person?.id === "string" && typeof person.name === "string" ? { id: person.id, name: person.name } : null;
}

/** The stored values that make sense: they may be from another version. @param {string | null} stored @returns {Values} */
function valid(stored) {
  const kept = storage.parsed(stored);
  const values = /** @type {Values} */ (Object.fromEntries(Object.entries(SETTINGS).map(([key, one]) => (
    [key, typeof kept?.[key] === typeof one.usual ? one.valid(kept[key]) : one.usual]))));
  // Version 0.1.0 had one setting for all gamepads. Where Stop was elsewhere, every button stops until they are mapped.
  if (kept?.gamepadStop !== undefined && kept.gamepadStop !== "1") values.pads = { ...values.pads, "": EVERY_STOP };
  return values;
}

/** @param {any} fit @returns {Record<string, Record<string, number>>} */
function validMeasures(fit) {
  return Object.fromEntries(Object.entries(fit ?? {}).filter(([, one]) => [one?.at, ...Object.values(one ?? {})].every(Number.isFinite)));
}
