/**
 * One or two switches drive: choices light up in turn, a press chooses. A direction moves until the next press.
 *
 * With one switch the light goes on by itself; with two, the second switch moves it on.
 */

import { DIRECTIONS } from "./dpad.js";
import { isInteractive } from "./keyboard.js";

/** After a motion that ended by itself, a press is still meant for the motion, ms. */
const LATE_PRESS_MS = 800;

/** @typedef {{id: string, label: string, act?: () => void}} Choice */

/** The four directions to choose from. @type {Choice[]} */
export const DIRECTION_CHOICES = Object.keys(DIRECTIONS).map((id) => ({ id, label: id[0].toUpperCase() + id.slice(1) }));

/**
 * @param {{list: HTMLElement, press: HTMLButtonElement, next: HTMLButtonElement, help: HTMLElement}} parts
 * @param {import("./inputs.js").Inputs | import("../personalise/answering.js").Answering} inputs
 * @param {import("../settings/settings.js").Settings} settings
 * @param {() => Choice[]} offered what there is to choose from now; what is called like a direction moves
 */
export function attachScanning(parts, inputs, settings, offered) {
  /** @type {Choice[]} */
  let choices = [];
  let lit = 0;
  let timer = 0;
  /** @type {string | null} */
  let moving = null;
  let endedAt = -Infinity;

  const on = () => settings.values.panel === "switch";
  const paint = () => {
    parts.list.replaceChildren(...choices.map((choice, index) => {
      const item = document.createElement("li");
      item.textContent = choice.label;
      item.dataset.choice = choice.id;
      if (index === lit) item.setAttribute("aria-current", "true");
      if (choice.id === moving) item.dataset.moving = "true";
      return item;
    }));
  };
  const goOn = () => {
    lit = (lit + 1) % choices.length;
    paint();
  };
  const restart = () => {
    clearInterval(timer);
    if (on() && settings.values.switches === "1" && moving === null) {
      timer = setInterval(goOn, settings.values.dwellS * 1000);
    }
  };
  const rest = () => {
    moving = null;
    inputs.release("switch");
    paint();
    restart();
  };
  const choose = () => {
    if (moving !== null) {
      rest();
      return;
    }
    if (performance.now() - endedAt < LATE_PRESS_MS) return;
    const choice = choices[lit];
    if (!choice) return;
    const direction = DIRECTIONS[/** @type {import("./dpad.js").Direction} */ (choice.id)];
    if (direction) {
      inputs.hold("switch", ...direction, true);
      // Another way of pressing may have been first.
      if (inputs.source === "switch") moving = choice.id;
    } else {
      choice.act?.();
    }
    paint();
    restart();
  };
  const refill = () => {
    const wanted = offered();
    if (wanted.map(({ id }) => id).join() === choices.map(({ id }) => id).join()) return;
    choices = wanted;
    lit = 0;
    paint();
    restart();
  };
  const explain = () => {
    const two = settings.values.switches === "2";
    parts.next.hidden = !two;
    const keys = two ? `${settings.values.nextKey} goes on, ${settings.values.switchKey} chooses` : `or ${settings.values.switchKey}`;
    parts.help.textContent = two
      ? `Next goes on, Switch chooses; a direction goes on until Switch is pressed again. Keys: ${keys}.`
      : `A press (${keys}) chooses what is lit; a direction goes on until the next press.`;
    restart();
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
  button(parts.next, goOn);
  window.addEventListener("keydown", (event) => {
    if (!on() || event.repeat || (isInteractive(event.target) && event.target !== parts.press)) return;
    const act = { [settings.values.nextKey]: goOn, [settings.values.switchKey]: choose }[event.code];
    if (!act) return;
    // Before the keyboard's own meaning of the key, and before the click that Enter would make of it.
    event.preventDefault();
    event.stopImmediatePropagation();
    act();
  }, { capture: true });

  inputs.addEventListener("dropped", () => {
    if (moving !== null) endedAt = performance.now();
    rest();
  });
  settings.addEventListener("change", explain);
  setInterval(refill, 100);
  refill();
  explain();

  return {
    /** A gamepad's button as a switch: the first chooses, the second goes on. @param {number} number @param {boolean} down */
    press(number, down) {
      if (!on() || number >= Number(settings.values.switches)) return false;
      if (down) (number === 0 ? choose : goOn)();
      return true;
    },
  };
}
