/** The large button next to Stop: it enables the arm, or asks to drive where another page drives, and says which. */

import { setDisabled, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { whoAsks } from "./driver_lease.js";

/**
 * The button's action now; null where it does nothing, which the state says why.
 * @param {Pick<Connection, "open" | "engaged" | "state" | "welcome">} connection @returns {{label: WordKey, does: "enable" | "ask" | null}}
 */
export function enableButtonOf({ open, engaged, state, welcome }) {
  if (!open || state === null) return { label: "layout.enable", does: null };
  if (state.you || state.driver === null) return { label: "layout.enable", does: engaged || state.lost ? null : "enable" };
  const asks = whoAsks(state, welcome?.id);
  if (asks === "you") return { label: "driver.asked_button", does: null };
  return { label: "driver.ask", does: asks === null ? "ask" : null };
}

/** @param {HTMLElement} button @param {Connection} connection @param {() => void} enable */
export function attachEnableButton(button, connection, enable) {
  const show = () => {
    const { label, does } = enableButtonOf(connection);
    setText(button, say(label));
    // Enter enables; it does not ask.
    if (label === "layout.enable") button.setAttribute("aria-keyshortcuts", "Enter");
    else button.removeAttribute("aria-keyshortcuts");
    setDisabled(button, does === null);
  };
  button.addEventListener("click", () => {
    const { does } = enableButtonOf(connection);
    if (does === "enable") enable();
    if (does === "ask") connection.send({ type: "ask_to_drive" });
  });
  whenever(connection, ["state", "open"], show);
}
