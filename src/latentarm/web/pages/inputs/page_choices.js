/** A switch's choices behind "More": help, recording, the page's other buttons, settings and pages. */

import { byId } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { settingChoices } from "../settings/setting_choices.js";

/** @import {Choice, Group} from "./scanner.js" */

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

/** Links that stand on a part of the page, but not to this page. @param {HTMLElement} part @returns {Choice[]} */
export function linkChoices(part) {
  const links = [...part.querySelectorAll("a")].filter((link) => link.closest("[hidden]") === null && !link.ariaCurrent);
  return links.map((link) => ({ id: `link-${link.pathname}`, label: link.textContent.trim(), act: () => link.click() }));
}

/** What every page has: the settings and the other pages, by the names in the row at the top. @param {Group} group @returns {Choice[]} */
export function commonChoices(group) {
  return [
    group("settings", say("settings.title"), () => settingChoices(byId("settings-form", HTMLFormElement), group)),
    group("pages", say("scanning.pages"), () => linkChoices(byId("pages"))),
  ];
}

/**
 * @param {Choice[]} help the levels of help
 * @param {Choice[]} here what this page offers besides
 * @param {Group} group
 * @returns {Choice}
 */
export function moreChoices(help, here, group) {
  return group("more", say("scanning.more"), () => [
    ...(help.length ? [group("help", say("help.title"), () => help)] : []),
    ...here,
    ...BUTTONS.flatMap(buttonChoice),
    ...commonChoices(group),
  ]);
}
