/** The button that drives the arm back to its start, and in words why it cannot. */

import { byId, setDisabled, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** @import {Connection} from "../connection/connection.js" */
/** @import {Choice} from "../inputs/scanner.js" */
/** @import {WordKey} from "../layout/words.js" */

/**
 * The button's action now, and the text next to it.
 *
 * @param {Pick<Connection, "driving" | "engaged" | "state">} connection
 * @returns {{does: "begin" | "end" | null, why: WordKey}}
 */
export function wayBackOf({ driving, engaged, state }) {
  if (!driving || state === null) return { does: null, why: "way_back.driver_only" };
  if (state.returning) return { does: "end", why: "way_back.on" };
  if (state.at_start) return { does: null, why: "way_back.at_start" };
  if (!engaged) return { does: null, why: "way_back.enable_first" };
  if (state.phase === "moving" || state.let_go_first) return { does: null, why: "way_back.let_go" };
  return { does: "begin", why: "way_back.help" };
}

/** @param {Connection} connection */
export function attachWayBack(connection) {
  const button = byId("way-back");
  const press = () => {
    const { does } = wayBackOf(connection);
    if (does !== null) connection.send({ type: "return", on: does === "begin" });
  };
  const show = () => {
    const { does, why } = wayBackOf(connection);
    setText(button, say(does === "end" ? "way_back.end" : "way_back.begin"));
    setText(byId("way-back-why"), say(why));
    setDisabled(button, does === null);
  };
  button.addEventListener("click", press);
  whenever(connection, ["state", "open"], show);

  return {
    /** Its place among the choices of a switch, where it can begin. @returns {Choice[]} */
    choices() {
      return wayBackOf(connection).does === "begin" ? [{ id: "way-back", label: say("way_back.begin"), act: press }] : [];
    },
  };
}
