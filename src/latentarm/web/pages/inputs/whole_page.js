/** Switches and gamepads on a page without a stick: its controls light up in turn, and a gamepad's button stops the arm. */

import { byId, setHidden } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { settingChoices } from "../settings/setting_choices.js";
import { Deflection } from "./deflection.js";
import { attachGamepad } from "./gamepad.js";
import { isTyping } from "./keyboard.js";
import { elementOf, pageControls } from "./page_controls.js";
import { pageChoices } from "./page_choices.js";
import { attachScanning, groupOf } from "./scanning.js";

/** @import {Choice} from "./scanner.js" */
/** @import {Settings} from "../settings/settings.js" */

const LIT = "lit";
const LIGHT_MS = 100;

/** Nothing on such a page moves the arm: what is pushed is only known. */
export class StillInput extends Deflection {
  constructor() {
    super();
    this.live = false;
    this.flowing = false;
  }

  /** The pushed element was removed. */
  halt() {
    this.neutral();
  }
}

/**
 * @param {Settings} settings
 * @param {() => void} stop
 */
export function attachWholePage(settings, stop) {
  const bar = byId("page-switch");
  const home = /** @type {HTMLElement} */ (bar.parentElement);
  const input = new StillInput();
  const stops = { id: "stop", label: say("layout.stop"), act: stop };
  const group = (/** @type {string} */ id, /** @type {string} */ label, /** @type {() => Choice[]} */ inner) => groupOf(id, label, inner, [stops]);

  const dialogNow = () => /** @type {HTMLDialogElement | null} */ (document.querySelector("dialog[open]"));
  const place = () => {
    // Nothing behind a dialog can be pressed, nor the bar of the switches.
    const within = dialogNow() ?? home;
    if (bar.parentElement !== within) within.append(bar);
    setHidden(bar, settings.values.panel !== "switch");
    setHidden(byId("panel-switch"), false);
  };
  const offered = () => {
    place();
    const dialog = dialogNow();
    if (dialog) return [...pageControls(dialog, group, dialog.id), stops];
    return [
      ...pageControls(byId("controls"), group),
      group("settings", say("settings.title"), () => settingChoices(byId("settings-form", HTMLFormElement), group)),
      group("pages", say("scanning.pages"), pageChoices),
      stops,
    ];
  };
  const scanner = attachScanning({
    list: byId("scan"),
    press: byId("switch", HTMLButtonElement),
    next: byId("switch-next", HTMLButtonElement),
    help: byId("scan-help"),
  }, input, settings, offered, isTyping);
  /** The page may have redrawn the lit element: look it up each time. */
  const light = () => {
    place();
    const lit = scanner.on ? elementOf(scanner.choices[scanner.lit]) : undefined;
    for (const other of [...document.getElementsByClassName(LIT)]) if (other !== lit) other.classList.remove(LIT);
    if (!lit || lit.classList.contains(LIT)) return;
    lit.classList.add(LIT);
    lit.scrollIntoView({ block: "nearest" });
  };
  scanner.addEventListener("change", light);
  setInterval(light, LIGHT_MS);
  light();
  attachGamepad(input, settings, { enable: () => {}, stop, gripper: () => {}, nextMode: () => {}, press: (number, down) => scanner.press(number, down) });
}
