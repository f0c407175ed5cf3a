/** Keys as people call them, and which of them is a switch. */

import { say } from "../layout/words.js";

/** @param {string} code as in `KeyboardEvent.code` */
export function keyWords(code) {
  return code === "Space" ? say("keys.space") : code.replace(/^(Key|Digit)/, "");
}

/** Whether this key is a switch now, on a page that scans. @param {Values} settings @param {string} code */
export function isSwitch({ panel, switches, switchKey, nextKey }, code) {
  return panel === "switch" && (code === switchKey || (switches === "2" && code === nextKey));
}
