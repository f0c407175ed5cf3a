/** Notices as this page's own person must read them: what they did themselves is not told of somebody else. */

import { say, sayNotice } from "../layout/words.js";

/** @import {Notice} from "./messages.js" */
/** @import {OwnPages} from "./own_pages.js" */
/** @import {WordKey} from "../layout/words.js" */

/** Notices about a page, which name it by its id. */
const DONE_BY_A_PAGE = ["stop_pressed_by", "page_stopped", "driver_gone", "driver_released", "handed_over"];

/** @typedef {{you: boolean, own: OwnPages, late: "page" | "connection" | null}} Reader
 *   whether they drive, which pages are theirs, and what was too slow where an input of theirs was late */

/**
 * @param {Notice} notice
 * @param {Reader} reader
 */
export function sayTo(notice, { you, own, late }) {
  const { code, parameters } = notice;
  if (DONE_BY_A_PAGE.includes(code) && own.has(parameters.page)) return say(/** @type {WordKey} */ (`yours.${code}`));
  if (you && code === "driver_changed") return say("yours.driver_changed");
  if (you && late !== null && code === "input_late") return say(`late.${late}`);
  return sayNotice(notice);
}

/** Notices for the person who drives, meaningless to those who watch. */
const FOR_THE_DRIVER = ["let_go_first", "stop_first", "return_not_now", "return_pushed"];

/** Whether a note concerns this page's person. @param {Notice | null} note @param {boolean} you @returns {note is Notice} */
export function concerns(note, you) {
  return note !== null && (you || !FOR_THE_DRIVER.includes(note.code));
}
