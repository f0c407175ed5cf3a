/** The button that drives the arm back to its start, and in words why it cannot. */

import { byId, setDisabled, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { goingOf } from "./poses.js";

/** Why the arm cannot go back now, or "help" where it can. @param {Pick<Connection, "driving" | "engaged" | "state">} connection */
export function wayBackOf(connection) {
  const why = goingOf(connection);
  return why !== "driver_only" && why !== "on" && connection.state?.at_start ? "at_start" : why;
}

/** @param {Connection} connection */
export function attachWayBack(connection) {
  const button = byId("way-back");
  const press = () => {
    const why = wayBackOf(connection);
    if (why === "help" || why === "on") connection.send({ type: "return", on: why === "help" });
  };
  const show = () => {
    const why = wayBackOf(connection);
    setText(button, say(why === "on" ? "way_back.end" : "way_back.begin"));
    setText(byId("way-back-why"), say(`way_back.${why}`));
    setDisabled(button, why !== "help" && why !== "on");
  };
  button.addEventListener("click", press);
  whenever(connection, ["state", "open"], show);
}
