/** Small texts that stay next to points of the scene, in both views. */

/** @import * as THREE from "three" */
/** @import {View, Views} from "./views.js" */

const LINE_PX = 22;
const RAISED_PX = 24;

/**
 * @typedef {object} Label
 * @property {THREE.Vector3 | null} point
 * @property {boolean} shown
 * @property {boolean} told whether it is never cut to its mark
 * @property {boolean} ghost whether it lies on its point, however close others are
 * @property {string} text
 * @property {number} opacity
 * @property {number} wide px
 * @property {number} narrow its width where it is cut, px
 * @property {HTMLElement[]} elements one in each view
 * @property {string[]} at where each of them is
 */

/** @typedef {{x: number, y: number, wide: number}} Box */

export class Labels {
  /** @param {Views} views */
  constructor(views) {
    this._views = views;
    /** @type {Map<string, Label>} */
    this._all = new Map();
    /** Measures texts without laying out the page. */
    this._ruler = /** @type {CanvasRenderingContext2D} */ (document.createElement("canvas").getContext("2d"));
    views.beforeFrame.push(() => views.views.forEach((view, index) => this._place(view, index)));
  }

  /**
   * @param {string} key
   * @param {THREE.Vector3 | null} point
   * @param {string} text
   * @param {{shown?: boolean, ghost?: string, thing?: number, mark?: string, told?: boolean, share?: string, opacity?: number}} [look]
   *   a share is left out where there is little room, and all but the mark of a text that is not told where it would cover another one
   */
  set(key, point, text, { shown = true, ghost, thing, mark = "", told = true, share, opacity = 1 } = {}) {
    const label = this._all.get(key) ?? this._make(key, ghost, thing);
    label.point = point?.clone() ?? null;
    label.shown = shown && point !== null;
    label.told = told || !mark;
    if (label.opacity !== opacity) for (const { style } of label.elements) style.opacity = String(opacity);
    label.opacity = opacity;
    const [whole, cut] = [[mark, text, share], [mark, share]].map((parts) => parts.filter(Boolean).join(" "));
    if (label.text === whole) return;
    label.text = whole;
    for (const element of label.elements) {
      const rest = document.createElement("span");
      rest.className = "label-text";
      rest.textContent = mark ? ` ${text}` : text;
      element.replaceChildren(mark, rest);
      if (share) element.dataset.share = share;
      else delete element.dataset.share;
    }
    [label.wide, label.narrow] = this._widths(label, [whole, cut]);
  }

  /** @param {string} key @param {string} [ghost] @param {number} [thing] @returns {Label} */
  _make(key, ghost, thing) {
    const elements = this._views.views.map((view) => {
      const element = document.createElement("span");
      element.className = ghost ? "label ghost" : "label";
      if (ghost) element.dataset.ghost = ghost;
      if (thing) element.dataset.thing = String(thing);
      view.labels.append(element);
      return element;
    });
    const label = { point: null, shown: true, told: true, ghost: Boolean(ghost), text: "", opacity: 1, wide: 0, narrow: 0, elements, at: [] };
    this._all.set(key, label);
    return label;
  }

  /** How wide a label is with each text, px. @param {Label} label @param {string[]} texts */
  _widths({ elements: [element], ghost }, texts) {
    const style = getComputedStyle(element);
    if (ghost) return texts.map(() => parseFloat(style.width));
    this._ruler.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
    const edges = [style.paddingLeft, style.paddingRight, style.borderLeftWidth, style.borderRightWidth];
    const around = edges.reduce((sum, edge) => sum + parseFloat(edge), 0);
    return texts.map((text) => around + this._ruler.measureText(text).width);
  }

  /** @param {View} view @param {number} index */
  _place(view, index) {
    /** @type {Box[]} */
    const placed = [];
    // Announced labels come first: they stay whole.
    const labels = [...this._all.values()].sort((a, b) => Number(b.told) - Number(a.told));
    for (const label of labels) {
      const { point, shown, elements } = label;
      const element = elements[index];
      if (element.hidden === shown) element.hidden = !shown;
      if (!shown || point === null) continue;
      const { x, y } = label.ghost ? this._within(view, label, point) : this._beside(view, label, point, element, placed);
      const transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      if (label.at[index] !== transform) element.style.transform = label.at[index] = transform;
    }
  }

  /** On its point; near the edge it is seen whole. @param {View} view @param {Label} label @param {THREE.Vector3} point */
  _within(view, { wide }, point) {
    const { x, y } = this._views.project(view, point);
    const clamped = (/** @type {number} */ at, /** @type {number} */ size) => Math.min(Math.max(at, wide / 2), size - wide / 2);
    return { x: clamped(x, view.width), y: clamped(y, view.height) };
  }

  /**
   * Above its point, where it covers no other one.
   *
   * @param {View} view
   * @param {Label} label
   * @param {THREE.Vector3} point
   * @param {HTMLElement} element
   * @param {Box[]} placed those before it; it is added
   */
  _beside(view, { told, wide, narrow }, point, element, placed) {
    const seen = this._views.project(view, point);
    const covered = (/** @type {Box} */ box) =>
      placed.find((other) => Math.abs(other.y - box.y) < LINE_PX && Math.abs(other.x - box.x) < (other.wide + box.wide) / 2);
    const within = (/** @type {number} */ size) => Math.min(Math.max(seen.x, size / 2 + 2), view.width - size / 2 - 2);
    let y = seen.y - RAISED_PX;
    const cut = !told && covered({ x: within(wide), y, wide }) !== undefined;
    if (element.classList.contains("cut") !== cut) element.classList.toggle("cut", cut);
    const size = cut ? narrow : wide;
    const x = within(size);
    // Those that would cover each other are stacked.
    for (let under = covered({ x, y, wide: size }); under; under = covered({ x, y, wide: size })) y = under.y - LINE_PX;
    placed.push({ x, y, wide: size });
    return { x, y };
  }
}
