/** Takes up the alignment that the person has chosen in their settings. */

import { TRIAL } from "../personalise/trial.js";
import { NO_PROFILE } from "../settings/settings.js";

/** @import {Connection} from "../connection/connection.js" */
/** @import {Settings} from "../settings/settings.js" */

/**
 * Asks for it once they drive and the arm is not enabled, once for each choice. Without a choice the server's stays.
 *
 * @param {Connection} connection
 * @param {Settings} settings
 */
export function attachProfileChoice(connection, settings) {
  let asked = "";

  const choose = () => {
    const { state, welcome } = connection;
    const { profile } = settings.values;
    const known = profile === NO_PROFILE || welcome?.profiles.includes(profile);
    // An older choice does not replace what is being tried.
    if (!state || !known || !connection.driving || connection.engaged || profile === asked || state.profile === TRIAL) return;
    asked = profile;
    const name = profile === NO_PROFILE ? null : profile;
    if (name !== state.profile) connection.send({ type: "profile", name });
  };
  connection.addEventListener("state", choose);
  settings.addEventListener("change", choose);
}
