/** After a change of what the stick does, what goes on without being held is let go; what is held, people let go. */

/** @import {Connection} from "../connection/connection.js" */
/** @import {DriveInput} from "./drive_input.js" */

/**
 * @param {Connection} connection
 * @param {DriveInput} input
 */
export function attachNeutralFirst(connection, input) {
  connection.addEventListener("state", () => {
    if (connection.driving && connection.state?.let_go_first && input.latched) input.neutral();
  });
}
