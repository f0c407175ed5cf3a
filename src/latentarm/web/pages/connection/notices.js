/** Notices as this page's own person must read them: what they did themselves is not told of somebody else. */

import { theThing } from "../layout/thing_words.js";
import { say, sayNotice } from "../layout/words.js";

/** @import {OwnPages} from "./own_pages.js" */

/** Notices about a page, which name it by its id. */
const DONE_BY_A_PAGE = ["stop_pressed_by", "page_stopped", "driver_gone", "driver_released", "handed_over"];

/** Reasons that concern the people who were there, and not the arm as it is now. */
const OF_A_DRIVE = [
  ...DONE_BY_A_PAGE, "stop_pressed", "driver_changed", "driver_expired", "input_late", "input_invalid", "loop_late", "latch_ended", "let_go_first", "idle",
  "message_invalid", "question_began", "copilot_began", "copilot_changed", "copilot_ended", "copilot_gone", "copilot_late", "guiding_ended", "guiding_page_gone",
];

/** @typedef {{you: boolean, own: OwnPages, late: "page" | "connection" | null, absent: boolean}} Reader
 *   whether they drive, which pages are theirs, what was too slow where an input of theirs was late, and whether it was before they came */

/** @param {Notice} notice @param {Reader} reader */
export function sayTo(notice, { you, own, late, absent }) {
  const { code, parameters } = notice;
  if (DONE_BY_A_PAGE.includes(code) && own.has(parameters.page)) return say(/** @type {WordKey} */ (`yours.${code}`));
  if (absent && OF_A_DRIVE.includes(code)) return say("halted.not_enabled");
  if (you && code === "driver_changed") return say("yours.driver_changed");
  if (you && late !== null && code === "input_late") return say(`late.${late}`);
  return sayNotice("thing" in parameters ? { code, parameters: { ...parameters, thing: theThing(String(parameters.thing)) } } : notice);
}

/** Notices for the person who drives, meaningless to those who watch. */
const FOR_THE_DRIVER = [
  "checklist_first", "let_go_first", "path_blocked", "pose_pushed", "pose_stuck", "pose_unreachable", "return_blocked", "return_not_now", "return_pushed", "return_stuck",
  "shadow_stays", "stop_first", "thing_moved", "touch_refused",
];

/** Whether a note concerns this page's person. @param {Notice | null} note @param {boolean} you @returns {note is Notice} */
export function concerns(note, you) {
  return note !== null && (you || !FOR_THE_DRIVER.includes(note.code));
}
