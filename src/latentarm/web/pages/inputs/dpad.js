/** Four large buttons: hold one, or press it for a step, or press it on and off. */

import { setText } from "../layout/dom.js";
import { say, sayNumber } from "../layout/words.js";
import { DIRECTIONS } from "./deflection.js";

/** @import {Direction, PersonInput} from "./deflection.js" */
/** @import {Settings} from "../settings/settings.js" */

/**
 * @param {HTMLElement} element the group of buttons
 * @param {HTMLElement} help
 * @param {PersonInput} inputs
 * @param {Settings} settings
 * @param {() => void} refused said when a press cannot move the arm yet
 */
export function attachDpad(element, help, inputs, settings, refused) {
  const buttons = /** @type {HTMLButtonElement[]} */ ([...element.querySelectorAll("button")]);
  /** @type {{pointer: number, button: HTMLButtonElement} | null} */
  let held = null;
  /** @type {HTMLButtonElement | null} */
  let latched = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  const show = (/** @type {HTMLButtonElement | null} */ pressed) => {
    for (const button of buttons) {
      button.dataset.pressed = String(button === pressed);
      if (settings.values.press === "latch") button.setAttribute("aria-pressed", String(button === pressed));
      else button.removeAttribute("aria-pressed");
    }
  };
  const letGo = () => {
    clearTimeout(timer);
    held = latched = null;
    inputs.release("dpad");
    show(null);
  };
  const begin = (/** @type {HTMLButtonElement} */ button, stays = false) => {
    const [x, y] = DIRECTIONS[/** @type {Direction} */ (button.dataset.direction)];
    inputs.hold("dpad", x, y, stays);
    show(button);
  };
  const step = (/** @type {HTMLButtonElement} */ button) => {
    letGo();
    begin(button);
    timer = setTimeout(letGo, settings.values.stepS * 1000);
  };
  const toggle = (/** @type {HTMLButtonElement} */ button) => {
    const again = latched === button;
    letGo();
    if (again) return;
    latched = button;
    begin(button, true);
  };

  for (const button of buttons) {
    button.addEventListener("pointerdown", (event) => {
      if (held !== null || event.button !== 0) return;
      if (!inputs.live) refused();
      else if (settings.values.press === "step") step(button);
      else if (settings.values.press === "latch") toggle(button);
      else {
        held = { pointer: event.pointerId, button };
        button.setPointerCapture(event.pointerId);
        begin(button);
      }
    });
    button.addEventListener("pointerup", (event) => {
      if (event.pointerId === held?.pointer) letGo();
    });
    for (const lost of ["pointercancel", "lostpointercapture"]) {
      button.addEventListener(lost, (event) => {
        if (/** @type {PointerEvent} */ (event).pointerId !== held?.pointer) return;
        letGo();
        inputs.halt("pointer_lost");
      });
    }
    // A click without a pointer comes from Enter or from a switch or a screen reader: there is nothing to hold.
    button.addEventListener("click", (event) => {
      if (event.detail !== 0) return;
      if (!inputs.live) refused();
      else if (settings.values.press === "latch") toggle(button);
      else step(button);
    });
    button.addEventListener("contextmenu", (event) => event.preventDefault());
  }
  inputs.addEventListener("dropped", letGo);
  const explain = () => {
    const { press, stepS } = settings.values;
    setText(help, say(`dpad.${press}`, { seconds: sayNumber(stepS, 1) }));
    show(latched);
  };
  settings.addEventListener("change", explain);
  explain();
}
