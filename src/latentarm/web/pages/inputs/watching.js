/** Where another page drives, the stick and the buttons do nothing, and are shown so; a press of them says why. */

/** @import {Connection} from "../connection/connection.js" */

/**
 * @param {HTMLElement[]} controls
 * @param {Connection} connection
 * @param {() => void} refused
 */
export function attachWatching(controls, connection, refused) {
  let watching = false;
  connection.addEventListener("state", () => {
    const { state } = connection;
    const now = state !== null && !state.you && state.driver !== null;
    if (now === watching) return;
    watching = now;
    for (const control of controls) control.setAttribute("aria-disabled", String(watching));
  });
  for (const control of controls) {
    // Capture: before the control takes the press.
    control.addEventListener("pointerdown", (event) => {
      if (!watching) return;
      event.stopPropagation();
      refused();
    }, { capture: true });
  }
}
