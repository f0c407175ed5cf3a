/** Who drives, who watches, and how one becomes the other. */

import { byId, setHidden, setText } from "../layout/dom.js";
import { say, sayName } from "../layout/words.js";

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

  /** @param {ClientMessage} message */
  send(message) {
    this.ask(() => this._connection.send(message));
  }

  forget() {
    this._until = -Infinity;
  }
}

/** Which page asks to drive: this one, another one, or none. @param {State} state @param {string | undefined} id of this page */
export function whoAsks({ asking }, id) {
  if (asking === null) return null;
  return asking === id ? "you" : "another";
}

/** A sentence about the driver for this page's person. @param {State} state @param {ReturnType<typeof whoAsks>} asks */
export function whoDrives(state, asks) {
  const { you, driver, driver_name, asking, asking_name, watchers } = state;
  const asker = asking_name === null ? say("driver.somebody") : sayName(asking_name);
  if (you && asking !== null) return say("driver.you_asked", { name: asker });
  if (you) return watchers ? say("driver.you_watched", { count: watchers }) : say("driver.you");
  if (driver === null) return say("driver.nobody");
  const name = driver_name === null ? say("driver.somebody_else") : sayName(driver_name);
  const text = say("driver.other", { name });
  if (asks === "you") return `${text} ${say("driver.asked", { name })}`;
  return asks === "another" ? `${text} ${say("driver.asked_already", { asking: asker })}` : text;
}

/** @param {Connection} connection */
export function attachDriverPanel(connection) {
  const [ask, handOver, release] = ["ask", "hand-over", "release"].map((id) => byId(id, HTMLButtonElement));
  const hasEnable = document.getElementById("enable") !== null;
  ask.addEventListener("click", () => connection.send({ type: "ask_to_drive" }));
  release.addEventListener("click", () => connection.send({ type: "release" }));
  handOver.addEventListener("click", () => {
    const asking = connection.state?.asking;
    if (asking) connection.send({ type: "hand_over", to: asking });
  });

  connection.addEventListener("state", () => {
    const { state, welcome } = connection;
    if (!state) return;
    const { you, asking, asking_name } = state;
    const asks = whoAsks(state, welcome?.id);
    // Where another page drives, the button next to Stop asks; a page without one asks here.
    setHidden(ask, you || (hasEnable && state.driver !== null));
    if (ask.disabled !== (asks !== null)) ask.disabled = asks !== null;
    setHidden(release, !you);
    setHidden(handOver, !you || asking === null);
    setText(handOver, asking_name === null ? say("driver.hand_over") : say("driver.hand_over_to", { name: sayName(asking_name) }));
    setText(byId("driver"), whoDrives(state, asks));
  });
}
