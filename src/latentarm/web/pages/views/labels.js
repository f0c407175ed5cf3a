/** Texts about points of the scene: names at the edge of the large view, with a line to what they name, and marks of arrows in both. */

import { ROW_PX, layOutNames } from "./label_layout.js";

/** @import * as THREE from "three" */
/** @import {Box, Name, Place} from "./label_layout.js" */
/** @import {View, Views} from "./views.js" */

/** How large what is named and the tool are, m, and at least, px. */
const THING_M = 0.03;
const LEAST_PX = 9;
/** Where an arrow is kept free, as shares of its length. */
const ALONG = [0.25, 0.5, 0.75];
/** How wide a link of the arm is, about its joint, m. */
const LINK_M = 0.07;
/** In a view narrower than this, px, shares are left out, and names are told alone that go before the others. */
const NARROW_PX = 480;
/** The corners of a view that others use: its name, and the button under it, px. */
const CAPTION = { wide: 92, high: 32 };
const BUTTON_PX = 52;

/**
 * @typedef {object} Label
 * @property {THREE.Vector3 | null} point
 * @property {boolean} shown
 * @property {boolean} told whether it goes before the others
 * @property {boolean} ghost whether it lies on its point
 * @property {string} text
 * @property {number} opacity
 * @property {number[]} widths px: whole, without its share, its mark and share, and its mark alone
 * @property {HTMLElement[]} elements one in each view
 * @property {HTMLElement[]} leaders likewise
 * @property {(Place | null)[]} places likewise
 */

export class Labels {
  /** @param {Views} views */
  constructor(views) {
    this._views = views;
    /** @type {Map<string, Label>} */
    this._all = new Map();
    /** Measures texts without laying out the page. */
    this._ruler = /** @type {CanvasRenderingContext2D} */ (document.createElement("canvas").getContext("2d"));
    /** @type {WeakMap<HTMLElement, string>} How elements were moved last. */
    this._moved = new WeakMap();
    views.beforeFrame.push(() => views.views.forEach((view, index) => this._place(view, index)));
  }

  /**
   * @param {string} key
   * @param {THREE.Vector3 | null} point
   * @param {string} text
   * @param {{shown?: boolean, ghost?: string, thing?: number, mark?: string, told?: boolean, share?: string, opacity?: number}} [look]
   *   a share is left out where there is little room, and all but the mark where a name has none
   */
  set(key, point, text, { shown = true, ghost, thing, mark = "", told = true, share, opacity = 1 } = {}) {
    const label = this._all.get(key) ?? this._make(key, ghost, thing);
    label.point = point?.clone() ?? null;
    label.shown = shown && point !== null;
    label.told = told || !mark;
    if (label.opacity !== opacity) for (const { style } of label.elements) style.opacity = String(opacity);
    label.opacity = opacity;
    const texts = [[mark, text, share], [mark, text], mark ? [mark, share] : [text, share], [mark || text]].map((parts) => parts.filter(Boolean).join(" "));
    const [whole] = texts;
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
    label.widths = this._widths(label, texts);
  }

  /** @param {string} key @param {string} [ghost] @param {number} [thing] @returns {Label} */
  _make(key, ghost, thing) {
    const made = (/** @type {View} */ view, /** @type {string} */ name) => {
      const element = document.createElement("span");
      element.className = name;
      element.hidden = true;
      if (ghost) element.dataset.ghost = ghost;
      if (thing) element.dataset.thing = String(thing);
      view.labels.append(element);
      return element;
    };
    const { views } = this._views;
    const leaders = ghost ? [] : views.map((view) => made(view, "leader"));
    const elements = views.map((view) => made(view, ghost ? "label ghost" : "label"));
    const label = {
      point: null, shown: true, told: true, ghost: Boolean(ghost), text: "", opacity: 1, widths: [0, 0, 0, 0], elements, leaders, places: views.map(() => null),
    };
    this._all.set(key, label);
    return label;
  }

  /** How wide a label is with each text, px. @param {Label} label @param {string[]} texts */
  _widths({ elements: [element], ghost }, texts) {
    const { hidden } = element;
    element.hidden = false;
    const style = getComputedStyle(element);
    const wide = parseFloat(style.width);
    this._ruler.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
    const edges = [style.paddingLeft, style.paddingRight, style.borderLeftWidth, style.borderRightWidth];
    const around = edges.reduce((sum, edge) => sum + parseFloat(edge), 0);
    element.hidden = hidden;
    if (ghost) return texts.map(() => wide);
    return texts.map((text) => around + this._ruler.measureText(text).width);
  }

  /** @param {View} view @param {number} index */
  _place(view, index) {
    const all = [...this._all.values()];
    const arrows = all.filter(({ ghost, shown }) => ghost && shown);
    for (const label of arrows) this._move(label.elements[index], this._within(view, label));
    const named = view === this._views.seen[0] ? all.filter(({ ghost, shown, point }) => !ghost && shown && point !== null).sort((a, b) => Number(b.told) - Number(a.told)) : [];
    for (const label of all) {
      const shown = label.ghost ? label.shown : named.includes(label);
      if (label.elements[index].hidden === shown) label.elements[index].hidden = !shown;
      if (!shown && label.leaders[index]) label.leaders[index].hidden = true;
    }
    const bare = view.width < NARROW_PX;
    const names = named.map(({ point, told, widths: [whole, name, share, mark], places }) => {
      const [wide, narrow] = bare ? [told ? name : mark, mark] : [whole, share];
      return { ...this._views.project(view, /** @type {THREE.Vector3} */ (point)), wide, narrow, before: places[index] };
    });
    const links = this._views.joints.map((joint) => this._about(view, joint, LINK_M));
    layOutNames(names, this._kept(view, named, arrows), links, view).forEach((place, at) => {
      this._put(named[at], names[at], place, index, bare);
    });
  }

  /** @param {Label} label @param {Name} name @param {Place | null} place @param {number} index of the view @param {boolean} bare */
  _put(label, { x, y, wide, narrow }, place, index, bare) {
    label.places[index] = place;
    const [element, leader] = [label.elements[index], label.leaders[index]];
    element.hidden = place === null;
    leader.hidden = !place?.leader;
    if (place === null) return;
    element.classList.toggle("cut", place.cut || (bare && !label.told));
    element.classList.toggle("bare", bare);
    this._move(element, { x: place.left + (place.cut ? narrow : wide) / 2, y: place.top + ROW_PX / 2 - 1 });
    if (!place.leader) return;
    const [across, along] = [x - place.leader.x, y - place.leader.y];
    const length = Math.max(Math.hypot(across, along) - LEAST_PX, 0);
    const turned = `translate(${place.leader.x.toFixed(1)}px, ${place.leader.y.toFixed(1)}px) rotate(${Math.atan2(along, across).toFixed(3)}rad)`;
    leader.style.transform = `${turned} scaleX(${length.toFixed(1)})`;
  }

  /** @param {HTMLElement} element @param {{x: number, y: number}} middle px */
  _move(element, { x, y }) {
    const transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
    if (this._moved.get(element) === transform) return;
    element.style.transform = transform;
    this._moved.set(element, transform);
  }

  /** What no name may cover: the tool, the things, the arrows along their way, and the corners. @param {View} view @param {Label[]} named @param {Label[]} arrows @returns {Box[]} */
  _kept(view, named, arrows) {
    const about = (/** @type {THREE.Vector3} */ point, size = THING_M, least = LEAST_PX) => this._about(view, point, size, least);
    const { tool } = this._views;
    const ways = arrows.flatMap(({ point, widths: [wide] }) => {
      return point ? [about(point, 0, wide / 2), ...ALONG.map((share) => about(tool.clone().lerp(point, share), 0))] : [];
    });
    return [
      { left: 0, top: 0, right: CAPTION.wide, bottom: CAPTION.high },
      { left: 0, top: view.height - BUTTON_PX, right: BUTTON_PX, bottom: view.height },
      about(tool), ...named.flatMap(({ point }) => (point ? [about(point)] : [])), ...ways, ...this._views.covered,
    ];
  }

  /** @param {View} view @param {THREE.Vector3} point @param {number} size m @param {number} [least] px @returns {Box} */
  _about(view, point, size, least = LEAST_PX) {
    const { x, y, perMetre } = this._views.project(view, point);
    const half = Math.max(size * perMetre, least);
    return { left: x - half, top: y - half, right: x + half, bottom: y + half };
  }

  /** On its point; near the edge it is seen whole. @param {View} view @param {Label} label */
  _within(view, { widths: [wide], point }) {
    const { x, y } = this._views.project(view, /** @type {THREE.Vector3} */ (point));
    const clamped = (/** @type {number} */ at, /** @type {number} */ size) => Math.min(Math.max(at, wide / 2), size - wide / 2);
    return { x: clamped(x, view.width), y: clamped(y, view.height) };
  }
}
