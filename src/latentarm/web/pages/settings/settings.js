/** What each person likes, kept in this browser under their name. */

export const DEFAULTS = Object.freeze({
  profile: "",
  sensitivity: 1,
  deadZone: 0.1,
  swapAxes: false,
  invertX: false,
  invertY: false,
  press: "hold",
  stepS: 0.5,
  panel: "stick",
  switches: "1",
  dwellS: 1.2,
  switchKey: "Enter",
  nextKey: "Backspace",
  gamepadStop: "1",
  shortcuts: true,
  seat: "facing",
  showGhosts: true,
  showTrail: true,
  showBound: false,
  theme: "auto",
});

/** Instead of a profile's name: no alignment, also where the server was started with one. */
export const NO_PROFILE = "-";

const LIMITS = { sensitivity: [0.1, 1], deadZone: [0, 0.5], stepS: [0.2, 2], dwellS: [0.4, 5] };
const PERSON_KEY = "latentarm.person";
const SETTINGS_KEY = "latentarm.settings.";

/** @typedef {typeof DEFAULTS} Values */

/** Event "change" after every change. */
export class Settings extends EventTarget {
  constructor() {
    super();
    this.name = stored(PERSON_KEY) ?? "";
    /** @type {Values} */
    this.values = read(this.name);
  }

  /** People who have settings here. @returns {string[]} */
  get people() {
    const keys = Array.from({ length: storageLength() }, (_, i) => localStorage.key(i) ?? "");
    return keys.filter((key) => key.startsWith(SETTINGS_KEY)).map((key) => key.slice(SETTINGS_KEY.length)).filter(Boolean);
  }

  /** Somebody else sits down: their settings, or the defaults. @param {string} name */
  become(name) {
    this.name = name.trim();
    store(PERSON_KEY, this.name);
    this.values = read(this.name);
    this.dispatchEvent(new Event("change"));
  }

  /** @param {Partial<Values>} changes */
  change(changes) {
    this.values = { ...this.values, ...changes };
    store(SETTINGS_KEY + this.name, JSON.stringify(this.values));
    this.dispatchEvent(new Event("change"));
  }

  reset() {
    this.change(DEFAULTS);
  }

  /**
   * From the stick to the person's own: dead zone, sensitivity, swapped and mirrored axes.
   *
   * @param {number} x right
   * @param {number} y up
   * @returns {[number, number]} right, up
   */
  shape(x, y) {
    const { deadZone, sensitivity, swapAxes, invertX, invertY } = this.values;
    const size = Math.hypot(x, y);
    if (size <= deadZone) return [0, 0];
    const reach = Math.max(Math.abs(x), Math.abs(y));
    // Grows from zero at the edge of the dead zone to full at the edge of the pad.
    const scale = (sensitivity * Math.min(1, (size - deadZone) / (size / reach - deadZone))) / reach;
    const right = (invertX ? -x : x) * scale;
    const up = (invertY ? -y : y) * scale;
    return swapAxes ? [up, right] : [right, up];
  }
}

/** What is stored, as far as it makes sense: it may be from another version. @param {string} name @returns {Values} */
function read(name) {
  /** @type {any} */
  const values = { ...DEFAULTS };
  let kept = {};
  try {
    kept = JSON.parse(stored(SETTINGS_KEY + name) ?? "{}") ?? {};
  } catch {
    return values;
  }
  for (const [key, value] of Object.entries(DEFAULTS)) {
    if (typeof kept[key] === typeof value) values[key] = kept[key];
  }
  for (const [key, [low, high]] of Object.entries(LIMITS)) {
    values[key] = Math.min(Math.max(values[key], low), high);
  }
  return values;
}

// Browsers may refuse storage altogether; settings then last as long as the page.
/** @param {string} key */
function stored(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** @param {string} key @param {string} value */
function store(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Nothing to be done: see above.
  }
}

function storageLength() {
  try {
    return localStorage.length;
  } catch {
    return 0;
  }
}
