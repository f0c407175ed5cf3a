/** Where the connection to a real arm is lost: a button that makes it again. The arm does not move for it. */

import { byId, setDisabled, setHidden, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** @param {Connection} connection @param {DriverLease} lease */
export function attachLostArm(connection, lease) {
  const button = byId("lost-again");
  const free = () => connection.driving || connection.state?.driver === null;
  const again = () => {
    if (connection.state?.lost && free()) lease.send({ type: "reconnect" });
  };
  const show = () => {
    setHidden(byId("lost"), !connection.state?.lost);
    setText(byId("lost-why"), say(free() ? "connection.help" : "connection.driver_only"));
    setDisabled(button, !free());
  };
  button.addEventListener("click", again);
  whenever(connection, ["state", "open"], show);
  return again;
}
