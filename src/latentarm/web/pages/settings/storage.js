/** The browser's storage for this site. It may refuse to keep anything; settings then last as long as the page. */

/** @typedef {"localStorage" | "sessionStorage"} Area */

/** @param {string} key @param {Area} [area] @returns {string | null} */
export function read(key, area = "localStorage") {
  try {
    return globalThis[area].getItem(key);
  } catch {
    return null;
  }
}

/** Parse stored JSON; null if it is not valid. @param {string | null} text @returns {any} */
export function parsed(text) {
  try {
    return JSON.parse(text ?? "null");
  } catch {
    return null;
  }
}

/** @param {string} key @param {string} value @param {Area} [area] */
export function write(key, value, area = "localStorage") {
  try {
    globalThis[area].setItem(key, value);
  } catch {
    // Refused, or full: see above.
  }
}

/** @param {string} key */
export function remove(key) {
  try {
    localStorage.removeItem(key);
  } catch {
    // Refused: then nothing was kept either.
  }
}
