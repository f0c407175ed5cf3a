/** Small texts that stay next to points of the scene, in both views. */

/** @import * as THREE from "three" */
/** @import {Views} from "./views.js" */

const LINE_PX = 22;
const RAISED_PX = 24;

export class Labels {
  /** @param {Views} views */
  constructor(views) {
    this._views = views;
    /** @type {Map<string, {point: THREE.Vector3 | null, shown: boolean, wide: number, elements: HTMLElement[]}>} */
    this._all = new Map();
    views.beforeFrame.push(() => this._place());
  }

  /**
   * @param {string} key
   * @param {THREE.Vector3 | null} point
   * @param {string} text
   * @param {{shown?: boolean, ghost?: string, thing?: number, share?: string, opacity?: number}} [look] a share is left out where there is little room
   */
  set(key, point, text, { shown = true, ghost, thing, share, opacity = 1 } = {}) {
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
      label = { point: null, shown, wide: 0, elements };
      this._all.set(key, label);
    }
    label.point = point?.clone() ?? null;
    label.shown = shown && point !== null;
    for (const { style } of label.elements) style.opacity = String(opacity);
    const [first] = label.elements;
    if (first.textContent === text && first.dataset.share === share) return;
    for (const element of label.elements) {
      element.textContent = text;
      if (share) element.dataset.share = share;
      else delete element.dataset.share;
    }
    label.wide = first.offsetWidth;
  }

  _place() {
    this._views.views.forEach((view, index) => {
      const width = view.element.clientWidth;
      /** @type {{x: number, y: number, wide: number}[]} */
      const placed = [];
      for (const { point, shown, elements, wide } of this._all.values()) {
        const element = elements[index];
        element.hidden = !shown;
        if (!shown || point === null) continue;
        let { x, y } = this._views.project(view, point);
        if (!element.classList.contains("ghost")) {
          y -= RAISED_PX;
          x = Math.min(Math.max(x, wide / 2 + 2), width - wide / 2 - 2);
          // Names that would cover each other are stacked.
          for (const other of placed) {
            if (Math.abs(other.y - y) < LINE_PX && Math.abs(other.x - x) < (other.wide + wide) / 2) y = other.y - LINE_PX;
          }
          placed.push({ x, y, wide });
        }
        element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      }
    });
  }
}
