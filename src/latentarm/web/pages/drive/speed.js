/** Slow, medium and fast, for a stick, buttons and switches alike. */

import { whenever } from "../layout/dom.js";

/** @import {Settings} from "../settings/settings.js" */

/** @param {HTMLElement} fieldset of shares of the full speed; the setting may also lie between them @param {Settings} settings */
export function attachSpeed(fieldset, settings) {
  const radios = fieldset.querySelectorAll("input");
  const show = () => radios.forEach((radio) => (radio.checked = Number(radio.value) === settings.values.sensitivity));
  fieldset.addEventListener("change", ({ target }) => settings.change({ sensitivity: Number(/** @type {HTMLInputElement} */ (target).value) }));
  whenever(settings, ["change"], show);
}
