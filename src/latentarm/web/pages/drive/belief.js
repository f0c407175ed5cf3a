/** The belief over goals as labelled bars, and how much the robot helps. */

/**
 * @param {{list: HTMLElement, none: HTMLElement, alpha: HTMLElement, alphaText: HTMLElement, level: HTMLElement}} parts
 */
export function attachBelief(parts) {
  /** @type {{item: HTMLElement, bar: HTMLElement, value: HTMLElement}[]} */
  let rows = [];

  return {
    /** @param {{name: string}[]} goals */
    name(goals) {
      rows = goals.map(({ name }, index) => {
        const item = document.createElement("li");
        const label = Object.assign(document.createElement("span"), { textContent: name, id: `goal-${index}` });
        const bar = Object.assign(document.createElement("span"), { className: "bar" });
        bar.setAttribute("role", "meter");
        bar.setAttribute("aria-labelledby", label.id);
        bar.setAttribute("aria-valuemin", "0");
        bar.setAttribute("aria-valuemax", "100");
        bar.append(Object.assign(document.createElement("span"), { className: "bar-fill" }));
        const value = Object.assign(document.createElement("span"), { className: "bar-value" });
        item.append(label, bar, value);
        return { item, bar, value };
      });
      parts.list.replaceChildren(...rows.map((row) => row.item));
    },

    /** @param {number[] | null} belief @param {number} alpha */
    show(belief, alpha) {
      parts.list.hidden = parts.level.hidden = belief === null;
      parts.none.hidden = belief !== null;
      const most = Math.max(...(belief ?? [0]));
      rows.forEach(({ item, bar, value }, index) => {
        const share = belief?.[index] ?? 0;
        fill(bar, value, share);
        item.dataset.likeliest = String(rows.length > 1 && share === most && share > 1.2 / rows.length);
      });
      fill(parts.alpha, parts.alphaText, alpha);
    },
  };
}

/** @param {HTMLElement} bar @param {HTMLElement} value @param {number} share */
function fill(bar, value, share) {
  const text = `${Math.round(100 * share)} %`;
  if (value.textContent === text) return;
  value.textContent = text;
  bar.setAttribute("aria-valuenow", String(Math.round(100 * share)));
  /** @type {HTMLElement} */ (bar.firstElementChild).style.width = `${100 * share}%`;
}
