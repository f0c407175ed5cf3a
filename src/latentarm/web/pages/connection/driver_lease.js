/** Who drives, who watches, and how one becomes the other. */

import { setText } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** @import {Connection} from "./connection.js" */
/** @import {State} from "./messages.js" */

/** How long the server may take to let this page drive where nobody does, ms. */
const ANSWER_MS = 1000;

/** Does what only the page that drives may do, and asks to drive first where that is needed. */
export class DriverLease {
  /** @param {Connection} connection */
  constructor(connection) {
    this._connection = connection;
    this._until = -Infinity;
    /** @type {() => void} */
    this._then = () => {};
    connection.addEventListener("state", () => {
      if (performance.now() > this._until || !connection.driving) return;
      this._until = -Infinity;
      this._then();
    });
  }

  /** At once where this page drives, soon where nobody does, never where another page does. @param {() => void} act */
  ask(act) {
    if (this._connection.driving) {
      act();
      return;
    }
    if (this._connection.state?.driver === null) {
      this._then = act;
      this._until = performance.now() + ANSWER_MS;
    }
    this._connection.send({ type: "ask_to_drive" });
  }

  /** What was asked for and waits is not done any more. */
  forget() {
    this._until = -Infinity;
  }
}

/**
 * Who drives, as this page's person is told.
 *
 * @param {State} state
 * @param {boolean} askedHere whether this page is the one that asks to drive
 */
export function whoDrives(state, askedHere) {
  const { you, driver, driver_name, asking, asking_name, watchers } = state;
  if (you && asking !== null) return say("driver.you_asked", { name: asking_name || say("driver.somebody") });
  if (you) return watchers ? say("driver.you_watched", { count: watchers }) : say("driver.you");
  if (driver === null) return say("driver.nobody");
  const text = say("driver.other", { name: driver_name || say("driver.somebody_else") });
  return askedHere ? `${text} ${say("driver.asked")}` : text;
}

/**
 * @param {{text: HTMLElement, ask: HTMLButtonElement, handOver: HTMLButtonElement, release: HTMLButtonElement}} parts
 * @param {Connection} connection
 */
export function attachDriverPanel(parts, connection) {
  parts.ask.addEventListener("click", () => connection.send({ type: "ask_to_drive" }));
  parts.release.addEventListener("click", () => connection.send({ type: "release" }));
  parts.handOver.addEventListener("click", () => {
    const asking = connection.state?.asking;
    if (asking) connection.send({ type: "hand_over", to: asking });
  });

  connection.addEventListener("state", () => {
    const { state, welcome } = connection;
    if (!state) return;
    const { you, asking, asking_name } = state;
    const askedHere = asking !== null && asking === welcome?.id;
    parts.ask.hidden = you;
    parts.ask.disabled = askedHere;
    parts.release.hidden = !you;
    parts.handOver.hidden = !you || asking === null;
    setText(parts.handOver, asking_name ? say("driver.hand_over_to", { name: asking_name }) : say("driver.hand_over"));
    setText(parts.text, whoDrives(state, askedHere));
  });
}
