/** What the browser keeps for this site. It may refuse to keep anything; settings then last as long as the page. */

/** @param {string} key @returns {string | null} */
export function read(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** @param {string} key @param {string} value */
export function write(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Refused, or full: see above.
  }
}

/** Keys that begin so. @param {string} prefix @returns {string[]} */
export function keys(prefix) {
  try {
    return Array.from({ length: localStorage.length }, (_, index) => localStorage.key(index) ?? "")
      .filter((key) => key.startsWith(prefix));
  } catch {
    return [];
  }
}
