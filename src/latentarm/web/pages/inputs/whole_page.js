/** Switches and gamepads on a page without a stick: its controls light up in turn, and a gamepad's button stops the arm. */

import { byId } from "../layout/dom.js";
import { Deflection } from "./deflection.js";
import { attachGamepad } from "./gamepad.js";
import { pageControls } from "./page_controls.js";
import { commonChoices } from "./page_choices.js";
import { attachScanning } from "./scanning.js";

/** @import {Settings} from "../settings/settings.js" */

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
  const input = new StillInput();
  const scanner = attachScanning(input, settings, stop, (_, group) => [...pageControls(byId("controls"), group), ...commonChoices(group)]);
  attachGamepad(input, settings, { enable: () => {}, stop, gripper: () => {}, nextMode: () => {}, press: (number, down) => scanner.press(number, down) });
}
