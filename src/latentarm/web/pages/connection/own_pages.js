/** Which pages this browser tab has been: each connection gets a new id, and the server names people by those. */

import * as storage from "../settings/storage.js";

const KEY = "latentarm.pages";
const KEPT = 20;

export class OwnPages {
  constructor() {
    const kept = storage.parsed(storage.read(KEY, "sessionStorage"));
    /** @type {string[]} */
    this._ids = Array.isArray(kept) ? kept : [];
  }

  /** @param {string} id of this connection */
  add(id) {
    if (this._ids.includes(id)) return;
    this._ids = [...this._ids, id].slice(-KEPT);
    storage.write(KEY, JSON.stringify(this._ids), "sessionStorage");
  }

  /** Whether this tab was the page with this id. @param {unknown} id */
  has(id) {
    return typeof id === "string" && this._ids.includes(id);
  }
}
