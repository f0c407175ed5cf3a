/** Each person's settings, kept in this browser under their id; `person_sync.js` keeps it on the server as well. */

import { EVERY_STOP, validMappings } from "./pads.js";
import * as storage from "./storage.js";

/**
 * @typedef {object} Values
 * @property {string} profile whose alignment; empty for what the server was started with, `NO_PROFILE` for none
 * @property {number} sensitivity largest input, in [0.1, 1]
 * @property {number} deadZone pushes smaller than this are ignored, in [0, 0.5]
 * @property {number} reach how far counts as a full push, in [0.4, 1]
 * @property {boolean} swapAxes
 * @property {boolean} invertX
 * @property {boolean} invertY
 * @property {"hold" | "step" | "latch"} press what a press does
 * @property {number} stepS length of a step, s
 * @property {number} latchS how long a motion goes on without being held, s
 * @property {"off" | "light" | "medium" | "strong"} tremor how much a trembling hand is steadied
 * @property {"off" | "low" | "medium" | "high"} help how much the robot helps
 * @property {"stick" | "dpad" | "switch"} panel what is pressed
 * @property {"1" | "2"} switches how many
 * @property {"auto" | "inverse" | "step"} scan how the light goes on with one switch
 * @property {"latch" | "hold"} switchMotion how a direction moves: until the next press, or while the switch is held
 * @property {number} dwellS how long a choice stays lit, s
 * @property {number} firstS how much longer the first one does, s
 * @property {number} acceptS how long a switch must be held before that counts, s
 * @property {number} releaseS how long a switch must have been up before a press counts, s
 * @property {boolean} debounced whether these two were stored by a version that debounces switches by default
 * @property {number} repeatS how often a switch that is held counts again, s; 0 for never
 * @property {boolean} rows whether long lists are scanned by rows
 * @property {boolean} bestFirst whether the direction that brings the task on is lit first
 * @property {boolean} speak whether what is lit is spoken
 * @property {boolean} speakNext whether what is to be done now is spoken
 * @property {number} speakVolume in [0, 1]
 * @property {string} switchKey key that chooses
 * @property {string} nextKey key that goes on
 * @property {Record<string, import("./pads.js").Mapping>} pads how gamepads are used, by their ids
 * @property {Record<string, Record<string, number>>} fit what was measured last with each input, and when
 * @property {boolean} shortcuts whether letters and digits drive
 * @property {"facing" | "behind"} seat where the person sits
 * @property {"front" | "side"} largeView which of the two views is the large one
 * @property {"camera" | "drawn"} picture what is seen of the arm where there are cameras
 * @property {boolean} showGhosts
 * @property {boolean} showTrail
 * @property {boolean} practised whether the guided practice was begun or skipped
 * @property {"none" | "success" | "all"} sounds what is heard: nothing, a task that is done, or Stop and Enable too
 * @property {boolean} vibration whether Stop and a task that is done are felt
 * @property {"auto" | "light" | "dark"} theme
 */

/** @type {Readonly<Values>} */
export const DEFAULTS = Object.freeze({
  profile: "",
  sensitivity: 0.5,
  deadZone: 0.1,
  reach: 1,
  swapAxes: false,
  invertX: false,
  invertY: false,
  press: "hold",
  stepS: 0.5,
  latchS: 10,
  tremor: "off",
  help: "medium",
  panel: "stick",
  switches: "1",
  scan: "auto",
  switchMotion: "latch",
  dwellS: 1.2,
  firstS: 0,
  // Of 168,000 people a key press takes 116 ms with an SD of 24 (Dhakal et al., CHI 2018): 0.05 s is nearly three below.
  acceptS: 0.05,
  releaseS: 0.2,
  debounced: true,
  repeatS: 0,
  rows: false,
  bestFirst: false,
  speak: false,
  speakNext: false,
  speakVolume: 0.8,
  switchKey: "Enter",
  nextKey: "Backspace",
  pads: {},
  fit: {},
  shortcuts: true,
  seat: "facing",
  largeView: "front",
  picture: "camera",
  showGhosts: true,
  showTrail: true,
  practised: false,
  sounds: "success",
  vibration: false,
  theme: "auto",
});

/** Instead of a profile's name: no alignment, also where the server was started with one. */
export const NO_PROFILE = "-";

/** @type {Record<string, [number, number]>} */
const LIMITS = {
  sensitivity: [0.1, 1], deadZone: [0, 0.5], reach: [0.4, 1], stepS: [0.2, 2], latchS: [1, 10], dwellS: [0.4, 5], firstS: [0, 3],
  acceptS: [0, 2], releaseS: [0, 2], repeatS: [0, 3], speakVolume: [0, 1],
};
/** @type {Record<string, string[]>} */
const CHOICES = {
  press: ["hold", "step", "latch"],
  panel: ["stick", "dpad", "switch"],
  switches: ["1", "2"],
  scan: ["auto", "inverse", "step"],
  switchMotion: ["latch", "hold"],
  tremor: ["off", "light", "medium", "strong"],
  help: ["off", "low", "medium", "high"],
  seat: ["facing", "behind"],
  largeView: ["front", "side"],
  picture: ["camera", "drawn"],
  sounds: ["none", "success", "all"],
  theme: ["auto", "light", "dark"],
};
const PERSON_KEY = "latentarm.person";
const SETTINGS_KEY = "latentarm.settings.";
/** Changes of a person's settings that the server may not have yet. */
export const UNSENT_KEY = "latentarm.unsent.";

/** @typedef {{id: string, name: string}} Person */

/** Events: "change" after every change, "edited" after those made here, "person" when somebody else sits down. */
export class Settings extends EventTarget {
  constructor() {
    super();
    /** Who sits here; null for a guest. @type {Person | null} */
    this.person = personIn(storage.read(PERSON_KEY));
    this.values = valid(storage.read(this._key));
  }

  get name() {
    return this.person?.name ?? "";
  }

  /** Somebody sits down, or a guest: their settings as this browser knows them, or the defaults. @param {Person | null} person */
  become(person) {
    this.person = person;
    if (person) storage.write(PERSON_KEY, JSON.stringify(person));
    else storage.remove(PERSON_KEY);
    // Before people had records, settings were kept under their names.
    this.values = valid(storage.read(this._key) ?? (person && storage.read(SETTINGS_KEY + person.name)));
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
    this.values = valid(JSON.stringify(values));
    storage.write(this._key, JSON.stringify(this.values));
    this.dispatchEvent(new Event("change"));
  }

  /** Nothing of a person stays in this browser. @param {Person} person */
  forget(person) {
    for (const key of [SETTINGS_KEY + person.id, SETTINGS_KEY + person.name, UNSENT_KEY + person.id]) storage.remove(key);
    if (this.person?.id === person.id) this.become(null);
  }

  /** @param {Partial<Values>} changes */
  change(changes) {
    this.values = { ...this.values, ...changes };
    storage.write(this._key, JSON.stringify(this.values));
    this.dispatchEvent(new Event("edited"));
    this.dispatchEvent(new Event("change"));
  }

  /** The defaults again; what was measured stays. */
  reset() {
    this.change({ ...DEFAULTS, fit: this.values.fit });
  }

  get _key() {
    return SETTINGS_KEY + (this.person?.id ?? "");
  }
}

/** @param {string | null} stored @returns {Person | null} */
function personIn(stored) {
  try {
    const person = JSON.parse(stored ?? "null");
    return typeof person?.id === "string" && typeof person.name === "string" ? { id: person.id, name: person.name } : null;
  } catch {
    return null;
  }
}

/** The stored values that make sense: they may be from another version. @param {string | null} stored @returns {Values} */
function valid(stored) {
  /** @type {any} */
  const values = { ...DEFAULTS };
  /** @type {any} */
  let kept = null;
  try {
    kept = JSON.parse(stored ?? "{}");
  } catch {
    return values;
  }
  // These zeros were the old defaults. Every change stores all values, so nobody need have chosen them.
  if (kept && !kept.debounced && kept.acceptS === 0 && kept.releaseS === 0) {
    kept = { ...kept, acceptS: DEFAULTS.acceptS, releaseS: DEFAULTS.releaseS };
  }
  for (const [key, value] of Object.entries(DEFAULTS)) {
    const mine = kept?.[key];
    if (typeof mine === typeof value && (CHOICES[key]?.includes(mine) ?? true)) values[key] = mine;
  }
  values.debounced = true;
  values.pads = validMappings(kept?.pads);
  values.fit = Object.fromEntries(Object.entries(kept?.fit ?? {}).filter(([, one]) => [one?.at, ...Object.values(one ?? {})].every(Number.isFinite)));
  // A version before had one setting for all gamepads. Where Stop was elsewhere, every button stops until they are mapped.
  if (kept?.gamepadStop !== undefined && kept.gamepadStop !== "1") values.pads[""] = EVERY_STOP;
  for (const [key, [low, high]] of Object.entries(LIMITS)) values[key] = Math.min(Math.max(values[key], low), high);
  return values;
}
