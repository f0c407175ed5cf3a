/**
 * The page's words: one catalogue per language, which the server puts into each page.
 *
 * An entry is a sentence with `{name}` where a parameter goes, or one sentence for each plural form of the parameter
 * `count`, named as `Intl.PluralRules` names them.
 */

/** @typedef {keyof typeof import("../../words/en.json")} WordKey */
/** @typedef {string | Record<string, string>} Entry */

/** @type {Record<string, Entry>} */
let catalogue = {};
let language = "en";
/** @type {Intl.PluralRules | null} Made once: it takes long. */
let plurals = null;

/** @param {string} newLanguage as in `<html lang>` @param {Record<string, Entry>} entries */
export function useWords(newLanguage, entries) {
  language = newLanguage;
  plurals = null;
  catalogue = entries;
}

export function readWords() {
  const element = document.getElementById("words");
  useWords(document.documentElement.lang, JSON.parse(element?.textContent ?? "{}"));
}

/** A text of the catalogue, or an error. @param {WordKey} key @param {Record<string, string | number>} [parameters] @returns {string} */
export function say(key, parameters = {}) {
  const entry = catalogue[key];
  if (entry === undefined) throw new Error(`the catalogue has no words for ${key}`);
  const form = () => (plurals ??= new Intl.PluralRules(language)).select(Number(parameters.count));
  const text = typeof entry === "string" ? entry : entry[form()] ?? entry.other;
  return text.replace(/\{(\w+)\}/g, (_, name) => String(parameters[name]));
}

/** Whether the catalogue has a text. @param {string} key */
export function knows(key) {
  return Object.hasOwn(catalogue, key);
}

/** A person's name; a guest without a name is a number. @param {string | number} name */
export function sayName(name) {
  return typeof name === "number" ? say("driver.guest", { number: name }) : name;
}

/** A notice of the server: a code with its parameters, of which `because` is the code of another notice. @param {Notice} notice */
export function sayNotice({ code, parameters }) {
  const spoken = { ...parameters };
  if ("name" in spoken) spoken.name = sayName(spoken.name);
  if ("because" in spoken) spoken.because = say(/** @type {WordKey} */ (`notice.${spoken.because}`), spoken);
  return say(`notice.${code}`, spoken);
}

/** A number as the language writes it. @param {number} value @param {number} [digits] after the decimal point */
export function sayNumber(value, digits = 0) {
  return value.toLocaleString(language, { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false });
}

/** Texts as a list. @param {string[]} texts */
export function sayList(texts) {
  return new Intl.ListFormat(language).format(texts);
}

/** A share as a percentage. @param {number} share @param {number} [digits] */
export function sayPercent(share, digits = 0) {
  return say("unit.percent", { value: digits ? sayNumber(100 * share, digits) : Math.round(100 * share) });
}
