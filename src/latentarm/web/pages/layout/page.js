/** The parts of every page: the person's settings, the connection, the state in one sentence, Stop, and the theme. */

import { Connection } from "../connection/connection.js";
import { attachDriverPanel, DriverLease } from "../connection/driver_lease.js";
import { attachInvitation } from "../connection/invitation.js";
import { attachStatus } from "../connection/status.js";
import { attachStop } from "../connection/stop.js";
import { attachFeedback } from "../feedback/feedback.js";
import { attachWakeLock } from "../feedback/wake_lock.js";
import { attachPersonSync } from "../settings/person_sync.js";
import { isSwitch } from "../inputs/keys.js";
import { Settings } from "../settings/settings.js";
import { attachSettingsDialog } from "../settings/settings_dialog.js";
import { attachTheme } from "../settings/theme.js";
import { byId, setHidden, setText, whenever } from "./dom.js";
import { robotWords } from "./thing_words.js";
import { attachTooLong } from "./too_long.js";
import { readWords, say } from "./words.js";

/**
 * @param {{drop?: () => void, repaint?: () => void, runChanged?: () => void}} [page] what this page lets
 *   go of at a Stop, draws anew when the theme changes, and does when another run has been loaded
 */
export function attachPage({ drop = () => {}, repaint = () => {}, runChanged = () => location.reload() } = {}) {
  readWords();
  const settings = new Settings();
  const connection = new Connection(settings.person);
  const status = attachStatus({ line: byId("status"), text: byId("status-text") }, connection, settings);
  const lease = new DriverLease(connection);
  const spaceStops = () => !isSwitch(settings.values, "Space");
  const stop = attachStop(connection, () => {
    lease.forget();
    drop();
  }, spaceStops);
  attachPersonSync(settings);
  const showKeys = () => byId("stop").setAttribute("aria-keyshortcuts", spaceStops() ? "Space Escape" : "Escape");
  whenever(settings, ["change"], showKeys);
  const offerProfiles = attachSettingsDialog(settings);
  attachTheme(settings, repaint);
  const feedback = attachFeedback(connection, settings);
  attachWakeLock(connection);
  attachTooLong();
  markKeysAtHand();
  // Pages from which nobody drives have no such panel.
  if (document.getElementById("driver")) {
    attachInvitation();
    attachDriverPanel(connection);
  }

  settings.addEventListener("person", () => connection.become(settings.person));
  connection.addEventListener("welcome", () => {
    if (!connection.welcome) return;
    const { run, latch_max_s, profiles, real } = connection.welcome;
    setHidden(byId("shadow"), !real?.shadow);
    const robot = robotWords(connection.welcome.robot);
    // In a study nobody may read how they drive.
    const fixed = document.documentElement.hasAttribute("data-fixed");
    const learned = run ? say("layout.about_run", { robot, run }) : say("layout.about_no_run", { robot });
    setText(byId("about"), fixed ? robot : learned);
    /** @type {HTMLInputElement | null} */ (document.querySelector("input[name=latchS]"))?.setAttribute("max", String(latch_max_s));
    offerProfiles(profiles);
  });
  connection.addEventListener("run_changed", runChanged);
  // It may be another arm, with other limits: nothing that was drawn, confirmed or chosen before counts.
  connection.addEventListener("server_changed", () => location.reload());
  // In a study: what comes next is at the same address. A second reload would abort a slow first one.
  const driveOver = (/** @type {Event} */ event) => {
    if (/** @type {CustomEvent} */ (event).detail.notice.code !== "drive_over") return;
    connection.removeEventListener("refused", driveOver);
    location.reload();
  };
  connection.addEventListener("refused", driveOver);
  connection.addEventListener("learning", () => {
    const { welcome, learning } = connection;
    if (!welcome || !learning || learning.profiles.join() === welcome.profiles.join()) return;
    welcome.profiles = learning.profiles;
    offerProfiles(learning.profiles);
  });
  return { settings, connection, status, lease, stop, feedback };
}

/**
 * Mark the page where a keyboard is at hand: `about-keys` is shown only there. No browser says so: where something points finely and
 * hovers, as a mouse does, a keyboard is likely; elsewhere only once a key was pressed. A touch screen's own keyboard sends no codes.
 */
function markKeysAtHand() {
  const desk = matchMedia("(any-pointer: fine) and (any-hover: hover)");
  const mark = () => document.documentElement.setAttribute("data-keys", "");
  if (desk.matches) mark();
  desk.addEventListener("change", mark);
  window.addEventListener("keydown", ({ code }) => code && mark(), { capture: true });
}
