/** The browser's storage for this site. It may refuse to keep anything, or be full; settings then last as long as the page. */

/** @typedef {"localStorage" | "sessionStorage"} Area */

/** Do it; null if the browser throws. @template T @param {() => T} act */
function tried(act) {
  try {
    return act();
  } catch {
    return null;
  }
}

/** @param {string} key @param {Area} [area] */
export const read = (key, area = "localStorage") => tried(() => globalThis[area].getItem(key));

/** Parse stored JSON; null if it is not valid. @param {string | null} text @returns {any} */
export const parsed = (text) => tried(() => JSON.parse(text ?? "null"));

/** @param {string} key @param {string} value @param {Area} [area] */
export const write = (key, value, area = "localStorage") => tried(() => globalThis[area].setItem(key, value));

/** @param {string} key */
export const remove = (key) => tried(() => localStorage.removeItem(key));
