/** Where the arm is slow, and what it keeps out of, in words: what is written in the views is no text for a screen reader. */

import { byId, setHidden, setText } from "../layout/dom.js";
import { zoneWords } from "../layout/thing_words.js";
import { say, sayList, sayNumber } from "../layout/words.js";

/** @param {Connection} connection */
export function attachZones(connection) {
  const text = byId("zones");
  connection.addEventListener("welcome", () => {
    const { zones, keep_out: solids } = connection.welcome ?? { zones: [], keep_out: [] };
    setHidden(text, zones.length + solids.length === 0);
    const entries = zones.map(({ name, speed }) => say("zone.entry", { zone: zoneWords(name), centimetres: sayNumber(100 * speed) }));
    const slow = zones.length ? [say("zone.list", { zones: sayList(entries) })] : [];
    const out = solids.length ? [say("zone.keep_out", { zones: sayList(solids.map(zoneWords)) })] : [];
    setText(text, [...slow, ...out].join(" "));
  });
}
