/** Where the arm is slow, what it keeps out of, and what it holds, in words: what is written in the views is no text for a screen reader. */

import { byId, setHidden, setText, whenever } from "../layout/dom.js";
import { thingWords, zoneWords } from "../layout/thing_words.js";
import { say, sayList, sayNumber } from "../layout/words.js";

/** @param {Connection} connection */
export function attachZones(connection) {
  const text = byId("zones");
  const show = () => {
    const { zones, keep_out: solids } = connection.welcome ?? { zones: [], keep_out: [] };
    const { held, gripper } = connection.state ?? { held: [], gripper: null };
    const entries = zones.map(({ name, speed }) => say("zone.entry", { zone: zoneWords(name), centimetres: sayNumber(100 * speed) }));
    const slow = zones.length ? [say("zone.list", { zones: sayList(entries) })] : [];
    const out = solids.length ? [say("zone.keep_out", { zones: sayList(solids.map(zoneWords)) })] : [];
    const holds = held.length ? [say("zone.held", { things: sayList(held.map(thingWords)) })] : gripper?.holding ? [say("zone.held_unknown")] : [];
    const said = [...slow, ...out, ...holds];
    setHidden(text, said.length === 0);
    setText(text, said.join(" "));
  };
  whenever(connection, ["welcome", "state"], show);
}
