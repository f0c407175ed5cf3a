/** Which pages this browser tab has been: each connection gets a new id, and the server names people by those. */

const KEY = "latentarm.pages";
const KEPT = 20;

/** @returns {string[]} */
function known() {
  try {
    const kept = JSON.parse(sessionStorage.getItem(KEY) ?? "[]");
    return Array.isArray(kept) ? kept : [];
  } catch {
    return [];
  }
}

export class OwnPages {
  constructor() {
    this._ids = known();
  }

  /** @param {string} id of this connection */
  add(id) {
    if (this._ids.includes(id)) return;
    this._ids = [...this._ids, id].slice(-KEPT);
    try {
      sessionStorage.setItem(KEY, JSON.stringify(this._ids));
    } catch {
      // Refused: they are known for as long as the page is open.
    }
  }

  /** Whether this tab was the page with this id. @param {unknown} id */
  has(id) {
    return typeof id === "string" && this._ids.includes(id);
  }
}
