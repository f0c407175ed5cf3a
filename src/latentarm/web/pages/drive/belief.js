/** The belief over goals as labelled bars, and how much the robot helps. */

import { create, fillBar, setHidden } from "../layout/dom.js";
import { thingWords } from "../layout/thing_words.js";
import { sayPercent } from "../layout/words.js";
import { isLikeliest } from "../views/likeliest.js";
import { colourOf, symbolOf } from "../views/symbols.js";

/** @import {State} from "../connection/messages.js" */

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
        const label = create("span", { textContent: `${symbolOf(index)} ${thingWords(name)}`, id: `goal-${index}` });
        const bar = create("span", { className: "bar" });
        bar.setAttribute("role", "meter");
        bar.setAttribute("aria-labelledby", label.id);
        bar.setAttribute("aria-valuemin", "0");
        bar.append(create("span", { className: "bar-fill" }));
        const value = create("span", { className: "bar-value" });
        const item = create("li");
        label.dataset.thing = String(colourOf(index));
        item.append(label, bar, value);
        return { item, bar, value };
      });
      parts.list.replaceChildren(...rows.map((row) => row.item));
    },

    /** @param {State} state */
    show({ belief, alpha, help, mode }) {
      setHidden(parts.list, belief === null);
      // With straight lines, and without anything learned, the robot cannot help.
      setHidden(parts.level, belief === null || help === null || mode === "end_effector");
      setHidden(parts.none, belief !== null);
      rows.forEach(({ item, bar, value }, index) => {
        fill(bar, value, belief?.[index] ?? 0);
        const likeliest = String(isLikeliest(belief, index));
        if (item.dataset.likeliest !== likeliest) item.dataset.likeliest = likeliest;
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
