/** Where the arm is slow, in words: what is written in the views is no text for a screen reader. */

import { setHidden, setText } from "../layout/dom.js";
import { zoneWords } from "../layout/thing_words.js";
import { say, sayList, sayNumber } from "../layout/words.js";

/** @import {Connection} from "../connection/connection.js" */

/**
 * @param {HTMLElement} text
 * @param {Connection} connection
 */
export function attachZones(text, connection) {
  connection.addEventListener("welcome", () => {
    const zones = connection.welcome?.zones ?? [];
    setHidden(text, zones.length === 0);
    const entries = zones.map(({ name, speed }) => say("zone.entry", { zone: zoneWords(name), centimetres: sayNumber(100 * speed) }));
    setText(text, say("zone.list", { zones: sayList(entries) }));
  });
}
