/** The settings as choices of a switch: every section of the dialog, every field that needs no typing. */

import { say } from "../layout/words.js";

/** Fields that need no typing, and that a switch can set without losing itself. */
const FIELDS = ":is(select, input[type=radio], input[type=checkbox], input[type=range]):not([data-not-scanned] *)";
/** How many steps a slider has for a switch, at most. */
const STEPS = 10;

/** One for each section. @param {HTMLFormElement} form the dialog's @param {Group} group @returns {Choice[]} */
export function settingChoices(form, group) {
  return [...form.querySelectorAll("fieldset")].flatMap((section, number) => {
    const id = `settings-${number}`;
    /** @type {NodeListOf<HTMLInputElement | HTMLSelectElement>} */
    const fields = section.querySelectorAll(FIELDS);
    const inner = () => [...fields].map((field, at) => fieldChoice(field, `${id}-${at}`, group));
    return fields.length ? [group(id, wordsOf(section.querySelector("legend")), inner)] : [];
  });
}

/** @param {HTMLInputElement | HTMLSelectElement} field @param {string} id @param {Group} group @returns {Choice} */
export function fieldChoice(field, id, group) {
  const label = wordsOf(field.closest("label"));
  if (field instanceof HTMLSelectElement) {
    const options = () => [...field.options].map((option, at) => ({
      id: `${id}-${at}`, label: marked(option.text, option.selected), act: () => set(field, option.value),
    }));
    return group(id, label, options);
  }
  if (field.type === "range") return group(id, label, () => [slide(field, `${id}-less`, -1), slide(field, `${id}-more`, 1)]);
  return {
    id,
    label: marked(label, field.checked),
    stays: true,
    act: () => {
      field.checked = field.type === "radio" || !field.checked;
      tell(field);
    },
  };
}

/** @param {HTMLInputElement} field @param {string} id @param {number} way @returns {Choice} */
function slide(field, id, way) {
  const [low, high, step] = [field.min, field.max, field.step].map(Number);
  const stride = Math.max(step, Math.round((high - low) / STEPS / step) * step);
  const shown = field.closest("label")?.querySelector("[data-shows]")?.textContent ?? field.value;
  return {
    id,
    label: say(way > 0 ? "scanning.more_of" : "scanning.less_of", { value: shown }),
    stays: true,
    act: () => set(field, String(Number(field.value) + way * stride)),
  };
}

/** @param {HTMLInputElement | HTMLSelectElement} field @param {string} value */
function set(field, value) {
  field.value = value;
  tell(field);
}

/** @param {Element} field */
function tell(field) {
  field.dispatchEvent(new Event("input", { bubbles: true }));
  field.dispatchEvent(new Event("change", { bubbles: true }));
}

/** @param {string} name @param {boolean} on */
function marked(name, on) {
  return say(on ? "scanning.now" : "scanning.plain", { name });
}

/** An element's text, without the values next to sliders. @param {Element | null} element @param {string} [without] what else is left out */
export function wordsOf(element, without = "template") {
  const copy = /** @type {Element | undefined} */ (element?.cloneNode(true));
  for (const part of copy?.querySelectorAll(`input, select, [data-shows], ${without}`) ?? []) part.remove();
  return (copy?.textContent ?? "").replace(/\s+/g, " ").trim();
}
