/** An alignment that is tried: whose it is, and whether it is kept. */

import { part, write } from "../layout/page.js";

/** The profile's name while it is tried. */
export const TRIAL = ".trial";

/**
 * @param {import("../connection/connection.js").Connection} connection
 * @param {import("../settings/settings.js").Settings} settings
 * @param {{ask: (act: () => void) => void}} seat
 */
export function attachTrial(connection, settings, seat) {
  let keeping = false;
  connection.addEventListener("workshop", () => {
    const { personalise } = connection.workshop;
    if (!keeping || personalise?.phase !== "kept") return;
    keeping = false;
    // In this browser the person drives with it from now on.
    settings.change({ profile: personalise.name });
  });
  return {
    keep() {
      keeping = true;
      seat.ask(() => connection.send("keep_alignment"));
    },
  };
}

/**
 * The banner on the Drive page.
 *
 * @param {import("../connection/connection.js").Connection} connection
 * @param {import("../settings/settings.js").Settings} settings
 * @param {{ask: (act: () => void) => void}} seat
 */
export function attachTrialBanner(connection, settings, seat) {
  const trial = attachTrial(connection, settings, seat);
  part("trial-keep").addEventListener("click", () => trial.keep());
  part("trial-discard").addEventListener("click", () => seat.ask(() => connection.send("discard_alignment")));
  const show = () => {
    const personalise = connection.workshop?.personalise;
    const tried = personalise?.phase === "learned" && connection.state?.profile === TRIAL;
    part("trial").hidden = !tried;
    if (!tried) return;
    write(part("trial-title"), `You are trying the alignment of ${personalise.name}.`);
    part("trial-why").hidden = !personalise.why;
    write(part("trial-why"), personalise.why ?? "");
  };
  connection.addEventListener("workshop", show);
  connection.addEventListener("state", show);
}
