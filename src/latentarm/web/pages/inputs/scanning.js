/** The list that scanning lights up, the switches' buttons and their keys. */

import { create, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { DIRECTION_NAMES } from "./deflection.js";
import { isInteractive } from "./keyboard.js";
import { Scanner } from "./scanner.js";

/** @import {PersonInput} from "./deflection.js" */
/** @import {Choice} from "./scanner.js" */
/** @import {Settings} from "../settings/settings.js" */

/** How often is looked whether other choices are offered, ms. */
const LOOK_MS = 100;

/** The four directions to choose from. @returns {Choice[]} */
export function directionChoices() {
  return DIRECTION_NAMES.map((id) => ({ id, label: say(`directions.${id}`) }));
}

/**
 * @param {{list: HTMLElement, press: HTMLButtonElement, next: HTMLButtonElement, help: HTMLElement}} parts
 * @param {PersonInput} input
 * @param {Settings} settings
 * @param {() => Choice[]} offered what there is to choose from now
 */
export function attachScanning(parts, input, settings, offered) {
  const scanner = new Scanner(input, settings);
  const choose = () => scanner.choose();
  const next = () => scanner.next();

  const paint = () => {
    parts.list.replaceChildren(...scanner.choices.map((choice, index) => {
      const item = create("li", { textContent: choice.label });
      item.dataset.choice = choice.id;
      if (index === scanner.lit) item.setAttribute("aria-current", "true");
      if (choice.id === scanner.moving) item.dataset.moving = "true";
      return item;
    }));
  };
  const explain = () => {
    const { switches, switchKey, nextKey } = settings.values;
    parts.next.hidden = switches !== "2";
    setText(parts.help, switches === "2" ? say("scanning.two", { nextKey, switchKey }) : say("scanning.one", { switchKey }));
  };
  const button = (/** @type {HTMLButtonElement} */ element, /** @type {() => void} */ act) => {
    element.addEventListener("pointerdown", (event) => {
      if (event.button === 0) act();
    });
    element.addEventListener("click", (event) => {
      if (event.detail === 0) act();
    });
  };
  button(parts.press, choose);
  button(parts.next, next);
  window.addEventListener("keydown", (event) => {
    if (!scanner.on || event.repeat || (isInteractive(event.target) && event.target !== parts.press)) return;
    const act = { [settings.values.nextKey]: next, [settings.values.switchKey]: choose }[event.code];
    if (!act) return;
    // Before the keyboard's own meaning of the key, and before the click that Enter would make of it.
    event.preventDefault();
    event.stopImmediatePropagation();
    act();
  }, { capture: true });

  scanner.addEventListener("change", paint);
  settings.addEventListener("change", explain);
  setInterval(() => scanner.offer(offered()), LOOK_MS);
  scanner.offer(offered());
  explain();
  return scanner;
}
