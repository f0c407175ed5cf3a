/** The settings' dialog: every change counts at once. */

import { attachLanguage } from "./language.js";
import { NO_PROFILE } from "./settings.js";

const TEXTS = /** @type {Record<string, (value: number) => string>} */ ({
  sensitivity: (value) => `${Math.round(100 * value)} %`,
  deadZone: (value) => `${Math.round(100 * value)} %`,
  stepS: (value) => `${value.toFixed(1)} s`,
  dwellS: (value) => `${value.toFixed(1)} s`,
});

/**
 * @param {HTMLDialogElement} dialog
 * @param {HTMLElement} opener
 * @param {import("./settings.js").Settings} settings
 */
export function attachSettingsDialog(dialog, opener, settings) {
  const form = /** @type {HTMLFormElement} */ (dialog.querySelector("form"));
  const fields = /** @type {HTMLInputElement[]} */ ([...form.querySelectorAll("input[name], select[name]")]);

  const show = () => {
    for (const field of fields) {
      const value = field.name === "name" ? settings.name : settings.values[/** @type {keyof import("./settings.js").Values} */ (field.name)];
      if (field.type === "checkbox") field.checked = Boolean(value);
      else if (field.type === "radio") field.checked = field.value === value;
      else if (document.activeElement !== field || field.type === "range") field.value = String(value);
    }
    for (const text of /** @type {NodeListOf<HTMLElement>} */ (form.querySelectorAll("[data-shows]"))) {
      const name = /** @type {keyof typeof TEXTS} */ (text.dataset.shows);
      text.textContent = TEXTS[name](Number(settings.values[/** @type {"stepS"} */ (name)]));
    }
    const people = /** @type {HTMLElement} */ (form.querySelector("datalist"));
    people.replaceChildren(...settings.people.map((value) => Object.assign(document.createElement("option"), { value })));
  };

  opener.addEventListener("click", () => {
    show();
    dialog.showModal();
  });
  dialog.addEventListener("close", () => opener.focus());
  form.addEventListener("input", (event) => {
    const field = /** @type {HTMLInputElement} */ (event.target);
    if (field.type === "text" || !field.name) return;
    const value = field.type === "checkbox" ? field.checked : field.type === "range" ? Number(field.value) : field.value;
    settings.change({ [field.name]: value });
  });
  form.addEventListener("change", (event) => {
    const field = /** @type {HTMLInputElement} */ (event.target);
    if (field.name === "name") settings.become(field.value);
  });
  form.addEventListener("keydown", (event) => {
    const field = /** @type {HTMLInputElement} */ (event.target);
    if (event.code === "Enter" && field.matches("input:not(.key)")) event.preventDefault();
    if (field.matches(".key")) askForKey(field, event, settings);
  });
  /** @param {string[]} names people whose alignment can be chosen */
  const offer = (names) => {
    const choices = [["", "as the server was started"], [NO_PROFILE, "none"], ...names.map((name) => [name, name])];
    /** @type {any} */ (form.elements).profile.replaceChildren(...choices.map(([value, textContent]) =>
      Object.assign(document.createElement("option"), { value, textContent })));
    show();
  };
  attachLanguage(/** @type {HTMLSelectElement} */ (form.querySelector("#language")));
  form.querySelector("#settings-reset")?.addEventListener("click", () => settings.reset());
  settings.addEventListener("change", show);
  return { offer };
}

/** Enter in a key's field, then the key itself. @param {HTMLInputElement} field @param {KeyboardEvent} event @param {import("./settings.js").Settings} settings */
function askForKey(field, event, settings) {
  if (event.code === "Tab" || event.code === "Escape" || event.code === "Space") {
    delete field.dataset.asking;
    field.value = String(settings.values[/** @type {"switchKey" | "nextKey"} */ (field.name)]);
    return;
  }
  event.preventDefault();
  if (field.dataset.asking) {
    delete field.dataset.asking;
    settings.change({ [field.name]: event.code });
    field.value = event.code;
  } else if (event.code === "Enter") {
    field.dataset.asking = "yes";
    field.value = "Press the key …";
  }
}
