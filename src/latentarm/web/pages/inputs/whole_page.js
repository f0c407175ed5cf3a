/** Switches and gamepads on a page without a stick: its controls light up in turn, and a gamepad's button stops the arm. */

import { byId } from "../layout/dom.js";
import { Deflection } from "./deflection.js";
import { attachGamepad } from "./gamepad.js";
import { pageControls } from "./page_controls.js";
import { commonChoices } from "./scan_choices.js";
import { attachScanning } from "./scanning.js";

/** @param {Settings} settings @param {() => void} stop */
export function attachWholePage(settings, stop) {
  /** Nothing on such a page moves the arm: what is pushed is only known. @type {PersonInput} */
  const input = Object.assign(new Deflection(), { live: false, flowing: false, halt: () => input.neutral() });
  const scanner = attachScanning(input, settings, stop, (_, group) => [...pageControls(byId("controls"), group), ...commonChoices(group)]);
  attachGamepad(input, settings, scanner, { stop });
}
