/** The keys that are switches: while a person scans, these reach the scan, before and instead of anything else. */

import { isSwitch } from "./keys.js";

/** Somebody types in a field for so long after the last click or other key in it, ms. */
const TYPING_MS = 5000;

/** @param {Scanner} scanner @param {PersonInput} input @param {Settings} settings */
export function attachSwitchKeys(scanner, input, settings) {
  /** Keys that are down as switches. @type {Map<string, number>} */
  const held = new Map();
  let typedAt = -Infinity;

  const types = (/** @type {Event} */ { target }) => {
    if (isText(target)) typedAt = performance.now();
  };
  /** A field keeps these keys while somebody types in it, unless the arm is enabled, and while it asks which key is a switch. */
  const isKept = (/** @type {EventTarget | null} */ target) =>
    (target instanceof HTMLElement && target.dataset.asking !== undefined)
    || (isText(target) && !input.live && performance.now() - typedAt < TYPING_MS);

  window.addEventListener("pointerdown", types, { capture: true });
  window.addEventListener("keydown", (event) => {
    if (!isSwitch(settings.values, event.code)) types(event);
    else if (!isKept(event.target)) {
      take(event);
      if (event.repeat) return;
      const number = event.code === settings.values.switchKey ? 0 : 1;
      held.set(event.code, number);
      scanner.press(number, true);
    }
  }, { capture: true });
  window.addEventListener("keyup", (event) => {
    const number = held.get(event.code);
    if (number === undefined) return;
    held.delete(event.code);
    take(event);
    scanner.press(number, false);
  }, { capture: true });
  window.addEventListener("blur", () => held.clear());
}

/** Neither the browser nor another part of the page gives the key a meaning. @param {KeyboardEvent} event */
function take(event) {
  event.preventDefault();
  event.stopImmediatePropagation();
}

/** True if keys write into it. @param {EventTarget | null} target */
function isText(target) {
  return target instanceof HTMLInputElement && !target.readOnly && target.selectionStart !== null;
}
