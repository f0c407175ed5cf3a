/** Slow, medium and fast, for a stick, buttons and switches alike. */

import { byId, whenever } from "../layout/dom.js";

/** Its choices are shares of the full speed; the setting may also lie between them. @param {Settings} settings */
export function attachSpeed(settings) {
  const fieldset = byId("speed");
  const radios = fieldset.querySelectorAll("input");
  const show = () => radios.forEach((radio) => (radio.checked = Number(radio.value) === settings.values.sensitivity));
  fieldset.addEventListener("change", ({ target }) => settings.change({ sensitivity: Number(/** @type {HTMLInputElement} */ (target).value) }));
  whenever(settings, ["change"], show);
}
