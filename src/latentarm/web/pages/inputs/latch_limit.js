/** Motion that goes on without being held ends after the time that its person has set, or the server's where that is shorter. */

/** @import {Connection} from "../connection/connection.js" */
/** @import {Settings} from "../settings/settings.js" */
/** @import {DriveInput} from "./drive_input.js" */

/**
 * @param {DriveInput} input
 * @param {Connection} connection
 * @param {Settings} settings
 */
export function attachLatchLimit(input, connection, settings) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  input.addEventListener("change", () => {
    if (!input.latched || input.source === null) {
      clearTimeout(timer);
      timer = undefined;
      return;
    }
    const longestS = Math.min(settings.values.latchS, connection.welcome?.limits.latch_max_s ?? Infinity);
    timer ??= setTimeout(() => {
      timer = undefined;
      input.neutral();
    }, 1000 * longestS);
  });
}
