/** Small texts that stay next to points of the scene, in both views. */

/** @import * as THREE from "three" */
/** @import {Views} from "./views.js" */

const LINE_PX = 22;
const RAISED_PX = 24;

/**
 * @typedef {object} Label
 * @property {THREE.Vector3 | null} point
 * @property {boolean} shown
 * @property {boolean} told whether it is never cut to its mark
 * @property {number} wide px
 * @property {number} narrow its width where it is cut, px
 * @property {HTMLElement[]} elements
 */

export class Labels {
  /** @param {Views} views */
  constructor(views) {
    this._views = views;
    /** @type {Map<string, Label>} */
    this._all = new Map();
    views.beforeFrame.push(() => this._place());
  }

  /**
   * @param {string} key
   * @param {THREE.Vector3 | null} point
   * @param {string} text
   * @param {{shown?: boolean, ghost?: string, thing?: number, mark?: string, told?: boolean, share?: string, opacity?: number}} [look]
   *   a share is left out where there is little room, and all but the mark of a text that is not told where it would cover another one
   */
  set(key, point, text, { shown = true, ghost, thing, mark = "", told = true, share, opacity = 1 } = {}) {
    let label = this._all.get(key);
    if (!label) {
      const elements = this._views.views.map((view) => {
        const element = document.createElement("span");
        element.className = ghost ? "label ghost" : "label";
        if (ghost) element.dataset.ghost = ghost;
        if (thing) element.dataset.thing = String(thing);
        view.labels.append(element);
        return element;
      });
      label = { point: null, shown, told, wide: 0, narrow: 0, elements };
      this._all.set(key, label);
    }
    label.point = point?.clone() ?? null;
    label.shown = shown && point !== null;
    label.told = told || !mark;
    for (const { style } of label.elements) style.opacity = String(opacity);
    const [first] = label.elements;
    const all = mark ? `${mark} ${text}` : text;
    if (first.textContent === all && first.dataset.share === share) return;
    for (const element of label.elements) {
      const rest = document.createElement("span");
      rest.className = "label-text";
      rest.textContent = mark ? ` ${text}` : text;
      element.replaceChildren(mark, rest);
      if (share) element.dataset.share = share;
      else delete element.dataset.share;
    }
    const cut = first.classList.contains("cut");
    label.wide = widthOf(first, false);
    label.narrow = widthOf(first, true);
    first.classList.toggle("cut", cut);
  }

  _place() {
    this._views.views.forEach((view, index) => {
      const { clientWidth: width, clientHeight: height } = view.element;
      /** @type {{x: number, y: number, wide: number}[]} */
      const placed = [];
      const covered = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ wide) =>
        placed.find((other) => Math.abs(other.y - y) < LINE_PX && Math.abs(other.x - x) < (other.wide + wide) / 2);
      // What is told comes first: it stays whole.
      const labels = [...this._all.values()].sort((a, b) => Number(b.told) - Number(a.told));
      for (const { point, shown, told, elements, wide, narrow } of labels) {
        const element = elements[index];
        element.hidden = !shown;
        if (!shown || point === null) continue;
        let { x, y } = this._views.project(view, point);
        if (!element.classList.contains("ghost")) {
          y -= RAISED_PX;
          const within = (/** @type {number} */ size) => Math.min(Math.max(x, size / 2 + 2), width - size / 2 - 2);
          const cut = !told && covered(within(wide), y, wide) !== undefined;
          const size = cut ? narrow : wide;
          element.classList.toggle("cut", cut);
          x = within(size);
          // Those that would cover each other are stacked.
          for (let under = covered(x, y, size); under; under = covered(x, y, size)) y = under.y - LINE_PX;
          placed.push({ x, y, wide: size });
        } else {
          // An arrow near the edge is seen whole.
          x = Math.min(Math.max(x, wide / 2), width - wide / 2);
          y = Math.min(Math.max(y, wide / 2), height - wide / 2);
        }
        element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      }
    });
  }
}

/** How wide it is, cut to its mark or whole, px. @param {HTMLElement} element @param {boolean} cut */
function widthOf(element, cut) {
  element.classList.toggle("cut", cut);
  return element.offsetWidth;
}
