/** The dialog of the settings: every change counts at once. */

import { byId, create } from "../layout/dom.js";
import { say, sayNumber, sayPercent } from "../layout/words.js";
import { unfocus } from "../inputs/keyboard.js";
import { keyWords } from "../inputs/keys.js";
import { attachLanguage } from "./language.js";
import { attachPadSection } from "./pad_section.js";
import { attachPersonChoice } from "./person_choice.js";
import { NO_PROFILE } from "./settings.js";

/** The text next to a slider: a time, whose name ends in S, or a share. @param {string} name @param {number} value */
function sliderWords(name, value) {
  if (!name.endsWith("S")) return sayPercent(value);
  if (name === "repeatS" && value === 0) return say("settings.never");
  return say("unit.seconds", { value: sayNumber(value, name === "acceptS" || name === "releaseS" ? 2 : 1) });
}

/** @param {Settings} settings @returns {(names: string[]) => void} takes the people whose alignment can be chosen */
export function attachSettingsDialog(settings) {
  const [dialog, form] = [byId("settings", HTMLDialogElement), byId("settings-form", HTMLFormElement)];
  const fields = /** @type {HTMLInputElement[]} */ ([...form.querySelectorAll("input[name], select[name]")]);

  const show = () => {
    for (const field of fields) {
      const value = settings.values[/** @type {keyof Values} */ (field.name)];
      if (field.type === "checkbox") field.checked = Boolean(value);
      else if (field.type === "radio") field.checked = field.value === value;
      else if (field.matches(".key")) field.value = field.dataset.asking ? say("settings.press_key") : keyWords(String(value));
      else if (document.activeElement !== field || field.type === "range") field.value = String(value);
    }
    for (const text of /** @type {NodeListOf<HTMLElement>} */ (form.querySelectorAll("[data-shows]"))) {
      const name = text.dataset.shows ?? "";
      text.textContent = sliderWords(name, Number(settings.values[/** @type {keyof Values} */ (name)]));
      /** @type {HTMLInputElement} */ (form.elements.namedItem(name)).ariaValueText = text.textContent;
    }
  };

  const offerPeople = attachPersonChoice(byId("settings-person", HTMLSelectElement), settings);
  byId("settings-open").addEventListener("click", (event) => {
    // The browser gives the focus back at once when the dialog closes: to the opener only where keys had opened it.
    unfocus(event);
    offerPeople();
    show();
    dialog.showModal();
  });
  form.addEventListener("input", (event) => {
    const field = /** @type {HTMLInputElement} */ (event.target);
    if (field.type === "text" || !field.name) return;
    const value = field.type === "checkbox" ? field.checked : field.type === "range" ? Number(field.value) : field.value;
    settings.change({ [field.name]: value });
  });
  /** A key's field asks for the key once it is clicked or entered, and until it is left. */
  const asks = (/** @type {Event} */ { type, target }) => {
    if (!(target instanceof HTMLInputElement) || !target.matches(".key")) return;
    if (type === "click") target.dataset.asking = "yes";
    else delete target.dataset.asking;
    show();
  };
  for (const type of ["click", "focusout"]) form.addEventListener(type, asks);
  form.addEventListener("keydown", (event) => {
    const field = /** @type {HTMLInputElement} */ (event.target);
    const { code } = event;
    if (!field.matches("input") || code === "Tab" || code === "Escape") return;
    if (code === "Enter" || field.matches(".key")) event.preventDefault();
    if (!field.matches(".key")) return;
    if (field.dataset.asking) {
      delete field.dataset.asking;
      settings.change({ [field.name]: code });
    } else if (code === "Enter" || code === "Space") field.click();
  });
  attachLanguage(byId("language", HTMLSelectElement), byId("language-offer"));
  attachPadSection(dialog, settings);
  byId("settings-reset").addEventListener("click", () => settings.reset());
  settings.addEventListener("change", show);

  return (names) => {
    const choices = [["", say("settings.profile_standard")], [NO_PROFILE, say("settings.profile_none")], ...names.map((name) => [name, name])];
    const options = choices.map(([value, textContent]) => create("option", { value, textContent }));
    fields.find(({ name }) => name === "profile")?.replaceChildren(...options);
    show();
  };
}
