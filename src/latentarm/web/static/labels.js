/** Small texts that stay beside points of the scene, in both views. */

export class Labels {
  /** @param {import("./views.js").Views} views */
  constructor(views) {
    this._views = views;
    /** @type {Map<string, {point: any, shown: boolean, elements: HTMLElement[]}>} */
    this._all = new Map();
    views.beforeFrame.push(() => this._place());
  }

  /**
   * @param {string} key
   * @param {any} point
   * @param {string} text
   * @param {{shown?: boolean, ghost?: string}} [look]
   */
  set(key, point, text, { shown = true, ghost } = {}) {
    let label = this._all.get(key);
    if (!label) {
      const elements = this._views.views.map((view) => {
        const element = document.createElement("span");
        element.className = ghost ? "label ghost" : "label";
        if (ghost) element.dataset.ghost = ghost;
        view.labels.append(element);
        return element;
      });
      label = { point: null, shown, elements };
      this._all.set(key, label);
    }
    label.point = point?.clone() ?? null;
    label.shown = shown && point !== null;
    for (const element of label.elements) {
      if (element.textContent !== text) element.textContent = text;
    }
  }

  _place() {
    for (const { point, shown, elements } of this._all.values()) {
      elements.forEach((element, index) => {
        element.hidden = !shown;
        if (!shown) return;
        const view = this._views.views[index];
        const { x, y } = this._views.project(view, point);
        const beside = element.classList.contains("ghost") ? "translate(-50%, -50%)" : "translate(-50%, -190%)";
        element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) ${beside}`;
      });
    }
  }
}
