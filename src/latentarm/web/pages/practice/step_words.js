/** Instructions in words for the input that the person has chosen. */

import { say } from "../layout/words.js";

/** @import {Values} from "../settings/settings.js" */
/** @import {Step} from "./steps.js" */

/** @param {Step} step @param {Values} values @param {boolean} hasGoals @returns {string} */
export function stepWords(step, values, hasGoals) {
  const { panel } = values;
  switch (step) {
    case "enable": return say(panel === "switch" ? "practice.enable_switch" : "practice.enable");
    case "press": return say(`practice.press_${panel}`);
    case "let_go": return panel === "switch" ? say("practice.let_go_switch") : say(`practice.let_go_${values.press}`);
    case "stop": return say(panel === "switch" ? "practice.stop_switch" : "practice.stop");
    case "reach": return say(hasGoals ? "practice.reach" : "practice.reach_nothing");
    default: return say(`practice.${step}`);
  }
}
