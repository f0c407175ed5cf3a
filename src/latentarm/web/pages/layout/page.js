/** What every page has: the person's settings, the line to the server, the state in one sentence, Stop, theme. */

import { Connection } from "../connection/connection.js";
import { seatFirst } from "../connection/driver_lease.js";
import { Settings } from "../settings/settings.js";
import { attachSettingsDialog } from "../settings/settings_dialog.js";
import { attachStatus } from "../connection/status.js";
import { attachStop } from "../connection/stop.js";
import { attachTheme } from "../settings/theme.js";

/** @param {string} id @returns {any} */
export const part = (id) => document.getElementById(id);

/** @param {HTMLElement} element @param {string} text */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/**
 * @param {{drop?: () => void, repaint?: () => void, otherRun?: () => void}} [page] what this page lets go of at a Stop,
 *   draws anew, and does when another run has been loaded
 */
export function attachFrame({ drop = () => {}, repaint = () => {}, otherRun = () => location.reload() } = {}) {
  const settings = new Settings();
  const connection = new Connection(settings.name);
  const status = attachStatus({ line: part("status"), text: part("status-text") }, connection);
  const seat = seatFirst(connection);
  const stop = attachStop(connection, () => {
    seat.forget();
    drop();
  });
  const dialog = attachSettingsDialog(part("settings"), part("settings-open"), settings);
  attachTheme(part("theme"), settings, repaint);

  let name = settings.name;
  settings.addEventListener("change", () => {
    if (settings.name !== name) connection.rename((name = settings.name));
  });
  connection.addEventListener("welcome", () => {
    const { robot, run, limits, profiles } = connection.welcome;
    if (part("about")) write(part("about"), run ? `${robot}, run ${run}` : `${robot}, tool directions only: no run is loaded`);
    write(part("latch-max"), String(limits.latch_max_s));
    dialog.offer(profiles);
  });
  connection.addEventListener("otherrun", otherRun);
  connection.addEventListener("workshop", () => {
    const { profiles } = connection.workshop;
    if (!connection.welcome || profiles.join() === connection.welcome.profiles.join()) return;
    connection.welcome.profiles = profiles;
    dialog.offer(profiles);
  });
  return { settings, connection, status, seat, stop, dialog };
}
