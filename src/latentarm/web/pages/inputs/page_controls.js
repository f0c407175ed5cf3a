/** The controls of a page or dialog as choices of a switch: section by section, everything that needs no typing. */

import { fieldChoice, wordsOf } from "../settings/setting_choices.js";

const PRESSED = "button, a[href], summary";
const FIELDS = "select, input[type=radio], input[type=checkbox], input[type=range]";
/** Parts that are a choice of their own, which opens what is in them: each has a name. */
const PARTS = "section, article, form[aria-label], fieldset, li";
/** A part with fewer controls than this is no list of its own. */
const FEWEST = 3;
/** Of a part without a name of its own, so much of its text is its name. */
const NAME_LENGTH = 50;

/** Which element a choice stands for. @type {WeakMap<Choice, HTMLElement>} */
const elements = new WeakMap();

/** The elements that light up with a choice. @param {Choice | undefined} choice */
export function elementOf(choice) {
  return choice && elements.get(choice);
}

/** @param {HTMLElement} root @param {Group} group @param {string} [id] under which they are known; the same controls have the same @returns {Choice[]} */
export function pageControls(root, group, id = "page") {
  return controlsIn(root).flatMap((element, at) => choicesOf(element, `${id}-${element.id || at}`, group));
}

/** @param {HTMLElement} element @param {string} id @param {Group} group @returns {Choice[]} */
function choicesOf(element, id, group) {
  if (element.matches(PARTS)) {
    const inner = pageControls(element, group, id);
    return inner.length < FEWEST ? inner : [known(group(id, nameOf(element), () => inner), element)];
  }
  // A field is drawn by its label.
  if (element instanceof HTMLInputElement || element instanceof HTMLSelectElement) return [known(fieldChoice(element, id, group), element.closest("label") ?? element)];
  return [known({ id, label: nameOf(element), act: () => element.click() }, element)];
}

/** The controls and parts that stand directly in it, in the order of the page; not Stop. @param {Element} root @returns {HTMLElement[]} */
function controlsIn(root) {
  return /** @type {HTMLElement[]} */ ([...root.children]).flatMap((element) => {
    if (!element.checkVisibility() || element.matches("[data-not-scanned], [data-stop], [aria-hidden=true]")) return [];
    if (element.matches(PARTS)) return [element];
    if (element.matches(PRESSED)) return canPress(element) ? [element] : [];
    if (element.matches(FIELDS)) return /** @type {HTMLInputElement} */ (element).disabled ? [] : [element];
    return controlsIn(element);
  });
}

/** @param {HTMLElement} element */
export function canPress(element) {
  if (!(element instanceof HTMLButtonElement)) return true;
  if (element.disabled || element.getAttribute("aria-disabled") === "true") return false;
  // A form that still needs typing cannot be sent.
  return element.type !== "submit" || (element.form?.checkValidity() ?? true);
}

/** @param {Choice} choice @param {HTMLElement} element */
function known(choice, element) {
  elements.set(choice, element);
  return choice;
}

/** @param {HTMLElement} element */
function nameOf(element) {
  const heading = document.getElementById(element.getAttribute("aria-labelledby") ?? "") ?? element.querySelector(":scope > legend");
  const name = element.getAttribute("aria-label") ?? wordsOf(heading ?? element, PRESSED);
  return name.length > NAME_LENGTH ? `${name.slice(0, NAME_LENGTH).trimEnd()} …` : name;
}
