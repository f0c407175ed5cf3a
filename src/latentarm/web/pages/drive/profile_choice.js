/** Takes up the alignment that the person has chosen in their settings. */

import { TRIAL } from "../personalise/trial.js";
import { NO_PROFILE } from "../settings/settings.js";

/**
 * Asks for it and says where they sit once they drive and the arm is not enabled, once for each choice. Without a choice of an
 * alignment the server's stays. @param {Connection} connection @param {Settings} settings
 */
export function attachProfileChoice(connection, settings) {
  let asked = "";

  const choose = () => {
    const { state, welcome } = connection;
    const { profile, seat } = settings.values;
    if (!connection.driving) asked = "";
    // An older choice does not replace what is being tried.
    if (!state || !connection.driving || connection.engaged || state.profile === TRIAL) return;
    const known = profile === NO_PROFILE || welcome?.profiles.includes(profile);
    const choice = JSON.stringify([known && profile, seat]);
    if (choice === asked) return;
    asked = choice;
    const chosen = profile === NO_PROFILE ? null : profile;
    connection.send({ type: "profile", name: known ? chosen : state.profile, seat });
  };
  connection.addEventListener("state", choose);
  settings.addEventListener("change", choose);
}
