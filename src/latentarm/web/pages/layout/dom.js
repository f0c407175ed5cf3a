/** Helpers for the page's elements. */

/** The page's element, or an error. @template {HTMLElement} [T=HTMLElement] @param {string} id @param {abstract new () => T} [kind] its class @returns {T} */
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

/** Say whether it can be pressed: it keeps the focus, and its place for a screen reader. @param {Element} element @param {boolean} off */
export function setDisabled(element, off) {
  if (element.getAttribute("aria-disabled") !== String(off)) element.setAttribute("aria-disabled", String(off));
}

/** Check the radio button with this value. @param {HTMLElement} group @param {string | number | null} value @param {boolean} free lets people choose another */
export function checkRadio(group, value, free) {
  for (const radio of group.querySelectorAll("input")) {
    radio.checked = radio.value === String(value);
    if (radio.disabled === free) radio.disabled = !free;
  }
}

/** Do it now, and again at each of these events. @param {EventTarget} target @param {string[]} types @param {() => void} act */
export function whenever(target, types, act) {
  for (const type of types) target.addEventListener(type, act);
  act();
}

/** @template {keyof HTMLElementTagNameMap} K @param {K} tag @param {Partial<HTMLElementTagNameMap[K]>} [properties] @param {(Node | string)[]} children @returns {HTMLElementTagNameMap[K]} */
export function create(tag, properties = {}, ...children) {
  const { dataset, ...others } = properties;
  const made = Object.assign(document.createElement(tag), others);
  Object.assign(made.dataset, dataset);
  if (children.length) made.append(...children);
  return made;
}

/** A button that does something when it is pressed. @param {string} textContent @param {() => void} act @param {Partial<HTMLButtonElement>} [properties] */
export function createButton(textContent, act, properties = {}) {
  const made = create("button", { type: "button", textContent, ...properties });
  made.addEventListener("click", act);
  return made;
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
