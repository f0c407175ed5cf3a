/** An alignment that is tried: whose it is, and whether it is kept. */

import { byId, setHidden, setText, whenever } from "../layout/dom.js";
import { say, sayNotice } from "../layout/words.js";

/** The profile's name while it is tried. */
export const TRIAL = ".trial";

/** @param {Connection} connection @param {Settings} settings @param {DriverLease} lease */
export function attachTrial(connection, settings, lease) {
  let keeping = false;
  connection.addEventListener("learning", () => {
    const personalise = connection.learning?.personalise;
    if (!keeping || personalise?.phase !== "kept") return;
    keeping = false;
    // In this browser the person drives with it from now on.
    settings.change({ profile: personalise.name });
  });
  return {
    keep() {
      keeping = true;
      lease.send({ type: "keep_alignment" });
    },
    discard() {
      lease.send({ type: "discard_alignment" });
    },
  };
}

/** The banner on the Drive page. @param {Connection} connection @param {Settings} settings @param {DriverLease} lease */
export function attachTrialBanner(connection, settings, lease) {
  const trial = attachTrial(connection, settings, lease);
  byId("trial-keep").addEventListener("click", trial.keep);
  byId("trial-discard").addEventListener("click", trial.discard);
  const show = () => {
    const personalise = connection.learning?.personalise;
    const tried = personalise?.phase === "learned" && connection.state?.profile === TRIAL ? personalise : null;
    setHidden(byId("trial"), tried === null);
    if (tried === null) return;
    setText(byId("trial-title"), say("trial.title", { name: tried.name }));
    setHidden(byId("trial-why"), !tried.why);
    setText(byId("trial-why"), tried.why ? sayNotice(tried.why) : "");
  };
  whenever(connection, ["learning", "state"], show);
}
