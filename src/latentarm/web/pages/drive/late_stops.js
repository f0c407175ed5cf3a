/** Tells the driver how often the arm stopped in this drive because inputs came too late. */

import { setText } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** @import {Connection} from "../connection/connection.js" */

/**
 * @param {HTMLElement} element
 * @param {Connection} connection
 */
export function attachLateStops(element, connection) {
  let shown = 0;
  connection.addEventListener("state", () => {
    const { state } = connection;
    const count = state?.you ? state.late_stops : 0;
    if (!state || count === shown) return;
    shown = count;
    element.hidden = count === 0;
    if (count) setText(element, say("late.stops", { count }));
  });
}
