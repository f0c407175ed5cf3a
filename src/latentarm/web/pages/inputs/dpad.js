/** Four large buttons: hold one, or press it for a step, or press it on and off. */

import { byId, setText, whenever } from "../layout/dom.js";
import { say, sayNumber } from "../layout/words.js";
import { DIRECTIONS } from "./deflection.js";
import { attachHeldPointer } from "./held_pointer.js";

/** @param {PersonInput} inputs @param {Settings} settings @param {() => void} [refused] said when a press cannot move the arm yet */
export function attachDpad(inputs, settings, refused = () => {}) {
  const buttons = byId("dpad").querySelectorAll("button");
  let holding = false;
  /** @type {HTMLButtonElement | null} */
  let latched = null;
  let timer = 0;
  /** The kind of pointer that presses; none of a click by other means. */
  let pointer = "";

  const show = (/** @type {HTMLButtonElement | null} */ pressed) => {
    for (const button of buttons) {
      button.dataset.pressed = String(button === pressed);
      if (settings.values.press === "latch") button.setAttribute("aria-pressed", String(button === pressed));
      else button.removeAttribute("aria-pressed");
    }
  };
  const letGo = () => {
    clearTimeout(timer);
    holding = false;
    latched = null;
    inputs.release("dpad");
    show(null);
  };
  const begin = (/** @type {HTMLButtonElement} */ button, stays = false) => {
    const [x, y] = DIRECTIONS[/** @type {Direction} */ (button.dataset.direction)];
    inputs.hold("dpad", x, y, stays, 0, pointer);
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
    const forget = attachHeldPointer(button, {
      begins: ({ pointerType }) => {
        if (holding) return false;
        pointer = pointerType;
        if (!inputs.live) refused();
        else if (settings.values.press === "step") step(button);
        else if (settings.values.press === "latch") toggle(button);
        else {
          holding = true;
          begin(button);
        }
        return holding;
      },
      ends: letGo,
      missed: letGo,
      lost: () => {
        letGo();
        inputs.halt("pointer_lost");
      },
    });
    inputs.addEventListener("dropped", forget);
    // A click without a pointer comes from Enter or from a switch or a screen reader: there is nothing to hold.
    button.addEventListener("click", (event) => {
      if (event.detail !== 0) return;
      pointer = "";
      if (!inputs.live) refused();
      else if (settings.values.press === "latch") toggle(button);
      else step(button);
    });
  }
  inputs.addEventListener("dropped", letGo);
  const explain = () => {
    const { press, stepS } = settings.values;
    setText(byId("dpad-help"), say(`dpad.${press}`, { seconds: sayNumber(stepS, 1) }));
    show(latched);
  };
  whenever(settings, ["change"], explain);
}
