/** A switch's choices behind "More": help, recording, the page's other buttons, settings and pages. */

import { byId } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { settingChoices } from "../settings/setting_choices.js";
import { groupOf } from "./scanning.js";

/** @import {Choice} from "./scanner.js" */

/** Buttons of the page, most wanted first. */
const BUTTONS = [
  "copilot-accept", "copilot-end", "trial-keep", "trial-discard", "record", "picture", "trail-clear", "hand-over", "ask", "release",
];

/**
 * A button of the page as a choice, while it can be pressed.
 *
 * @param {string} id
 * @returns {Choice[]}
 */
export function buttonChoice(id) {
  const button = document.getElementById(id);
  if (!(button instanceof HTMLButtonElement) || button.disabled || button.closest("[hidden]") !== null) return [];
  return [{ id: `button-${id}`, label: button.textContent.trim(), act: () => button.click() }];
}

/** Links that stand on a part of the page. @param {HTMLElement} part @returns {Choice[]} */
export function linkChoices(part) {
  const links = [...part.querySelectorAll("a")].filter((link) => link.closest("[hidden]") === null);
  return links.map((link) => ({ id: `link-${link.pathname}`, label: link.textContent.trim(), act: () => link.click() }));
}

/** The other pages, by the names in the row at the top. @returns {Choice[]} */
export function pageChoices() {
  const links = /** @type {HTMLAnchorElement[]} */ ([...byId("pages").querySelectorAll("a:not([aria-current])")]);
  return links.map((link) => ({ id: `page-${link.pathname}`, label: link.textContent.trim(), act: () => link.click() }));
}

/**
 * @param {Choice[]} help the levels of help
 * @param {Choice[]} here what this page offers besides
 * @param {Choice} stop in reach from everywhere
 * @returns {Choice}
 */
export function moreChoices(help, here, stop) {
  const group = (/** @type {string} */ id, /** @type {string} */ label, /** @type {() => Choice[]} */ inner) => groupOf(id, label, inner, [stop]);
  return group("more", say("scanning.more"), () => [
    ...(help.length ? [group("help", say("help.title"), () => help)] : []),
    ...here,
    ...BUTTONS.flatMap(buttonChoice),
    group("settings", say("settings.title"), () => settingChoices(byId("settings-form", HTMLFormElement), group)),
    group("pages", say("scanning.pages"), pageChoices),
  ]);
}
