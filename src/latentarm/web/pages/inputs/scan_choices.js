/** A switch's choices behind "More": help, recording, the page's other buttons, settings and pages. */

import { byId } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { canPress } from "./page_controls.js";
import { fieldChoice, settingChoices } from "../settings/setting_choices.js";

/** Buttons of the page, most wanted first. */
const BUTTONS = [
  "copilot-accept", "copilot-end", "trial-keep", "trial-discard", "record", "view-swap", "trail-clear", "hand-over", "ask", "release",
];

/** A button of the page as a choice, while it can be pressed. @param {string} id @returns {Choice[]} */
export function buttonChoice(id) {
  const button = document.getElementById(id);
  if (!(button instanceof HTMLButtonElement) || !canPress(button) || button.closest("[hidden]") !== null) return [];
  return [{ id, label: button.ariaLabel ?? button.textContent.trim(), act: () => button.click() }];
}

/** One of several, while it can be chosen. @param {HTMLElement} fieldset @param {Group} group @returns {Choice[]} */
export function radioChoices(fieldset, group) {
  const radios = fieldset.hidden ? [] : [...fieldset.querySelectorAll("input")].filter(({ disabled }) => !disabled);
  return radios.map((radio, at) => ({ ...fieldChoice(radio, `${fieldset.id}-${at}`, group), stays: false }));
}

/** Links that stand on a part of the page, but not to this page. @param {HTMLElement} part @returns {Choice[]} */
export function linkChoices(part) {
  const links = [...part.querySelectorAll("a")].filter((link) => link.closest("[hidden]") === null && !link.ariaCurrent);
  return links.map((link) => ({ id: `link-${link.pathname}`, label: link.textContent.trim(), act: () => link.click() }));
}

/** True if the host has locked the settings. */
function locked() {
  return byId("settings-open", HTMLButtonElement).disabled;
}

/** The choices of every page: the settings and the other pages, by the names in the row at the top. @param {Group} group @returns {Choice[]} */
export function commonChoices(group) {
  return [
    ...(locked() ? [] : [group("settings", say("settings.title"), () => settingChoices(byId("settings-form", HTMLFormElement), group))]),
    group("pages", say("scanning.pages"), () => linkChoices(byId("pages"))),
  ];
}

/** @param {Choice[]} help the levels of help @param {Choice[]} here what this page offers besides @param {Group} group */
export function moreChoices(help, here, group) {
  return group("more", say("scanning.more"), () => [
    ...(help.length && !locked() ? [group("help", say("help.title"), () => help)] : []),
    ...here,
    ...BUTTONS.flatMap(buttonChoice),
    ...commonChoices(group),
  ]);
}
