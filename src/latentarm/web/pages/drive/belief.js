/** The belief over goals as labelled bars, and how much the robot helps. */

import { create, fillBar } from "../layout/dom.js";
import { sayPercent } from "../layout/words.js";

/** A goal is called the likeliest where its share is so many times that of a belief which prefers none. */
const CLEARLY = 1.2;

/** Whether a goal is what the robot takes to be meant. @param {number[] | null} belief @param {number} index */
export function isLikeliest(belief, index) {
  if (belief === null || belief.length < 2) return false;
  const most = Math.max(...belief);
  return belief[index] === most && most > CLEARLY / belief.length;
}

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
        const label = create("span", { textContent: name, id: `goal-${index}` });
        const bar = create("span", { className: "bar" });
        bar.setAttribute("role", "meter");
        bar.setAttribute("aria-labelledby", label.id);
        bar.setAttribute("aria-valuemin", "0");
        bar.append(create("span", { className: "bar-fill" }));
        const value = create("span", { className: "bar-value" });
        const item = create("li");
        item.append(label, bar, value);
        return { item, bar, value };
      });
      parts.list.replaceChildren(...rows.map((row) => row.item));
    },

    /** @param {number[] | null} belief @param {number} alpha */
    show(belief, alpha) {
      parts.list.hidden = parts.level.hidden = belief === null;
      parts.none.hidden = belief !== null;
      rows.forEach(({ item, bar, value }, index) => {
        fill(bar, value, belief?.[index] ?? 0);
        item.dataset.likeliest = String(isLikeliest(belief, index));
      });
      fill(parts.alpha, parts.alphaText, alpha);
    },
  };
}

/** @param {HTMLElement} bar @param {HTMLElement} value @param {number} share */
function fill(bar, value, share) {
  const text = sayPercent(share);
  if (value.textContent === text) return;
  value.textContent = text;
  fillBar(bar, 100 * share);
}
