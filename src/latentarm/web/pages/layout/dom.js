/** Helpers for the page's elements. */

/**
 * The element with this id.
 *
 * @template {HTMLElement} [T=HTMLElement]
 * @param {string} id
 * @param {abstract new () => T} [kind] the class that it must have
 * @returns {T}
 * @throws {Error} where the page has no such element.
 */
export function byId(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof (kind ?? HTMLElement))) throw new Error(`the page has no ${kind?.name ?? "element"} #${id}`);
  return /** @type {T} */ (found);
}

/** Write only what has changed: screen readers announce every write. @param {Element} element @param {string} text */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Show or hide it, where that changes anything: browsers style a part of the page anew with every write. @param {HTMLElement} element @param {boolean} hidden */
export function setHidden(element, hidden) {
  if (element.hidden !== hidden) element.hidden = hidden;
}

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Partial<HTMLElementTagNameMap[K]>} [properties]
 * @returns {HTMLElementTagNameMap[K]}
 */
export function create(tag, properties = {}) {
  return Object.assign(document.createElement(tag), properties);
}

/** A part of a drawing in SVG. @param {string} name @param {Record<string, string | number>} attributes @param {string} [text] */
export function part(name, attributes, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  made.textContent = text;
  return made;
}

/** A bar of `.bar` with its fill. @param {HTMLElement} bar @param {number} done @param {number} [all] */
export function fillBar(bar, done, all = 100) {
  bar.setAttribute("aria-valuemax", String(all));
  bar.setAttribute("aria-valuenow", String(Math.round(done)));
  /** @type {HTMLElement} */ (bar.firstElementChild).style.width = `${(100 * done) / all}%`;
}
