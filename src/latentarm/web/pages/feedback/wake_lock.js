/** The screen stays on while this page drives an enabled arm, or guides one: a screen that goes dark takes Stop with it. */

/** @import {Connection} from "../connection/connection.js" */

/** Browsers offer it to secure pages alone; elsewhere the system's own setting counts. @param {Connection} connection */
export function attachWakeLock(connection) {
  const screens = navigator.wakeLock;
  if (!screens) return;
  let wanted = false;
  /** @type {WakeLockSentinel | null} */
  let lock = null;

  const ask = async () => {
    try {
      lock = await screens.request("screen");
    } catch {
      return; // refused, for a battery that is nearly empty for example: the arm can be driven all the same
    }
    // The arm may have stopped meanwhile.
    if (!wanted) letGo();
  };
  const letGo = () => {
    lock?.release();
    lock = null;
  };
  const look = () => {
    const now = connection.driving && (connection.engaged || connection.state?.guiding === "on");
    if (now === wanted) return;
    wanted = now;
    if (wanted) ask();
    else letGo();
  };
  connection.addEventListener("state", look);
  connection.addEventListener("open", look);
}
