/** Instructions for the input that the person has chosen, as keys of the words. */

/** @import {Step} from "./steps.js" */

/** @param {Exclude<Step, "watch" | "reach">} step @param {Pick<Values, "panel" | "press" | "switchMotion">} values @returns {WordKey} */
export function stepKey(step, { panel, press, switchMotion }) {
  const switches = panel === "switch";
  switch (step) {
    case "enable": return switches ? "practice.enable_switch" : "practice.enable";
    case "press": return `practice.press_${panel}`;
    case "let_go": return switches ? `practice.let_go_switch_${switchMotion}` : `practice.let_go_${press}`;
    default: return switches ? "practice.stop_switch" : "practice.stop";
  }
}

/**
 * What the practice asks of the person while the arm is enabled; null where the arm's own sentence is enough. @param {Step | null} step
 * @param {State["phase"]} phase @param {boolean} pressed @param {Parameters<typeof stepKey>[1]} values @param {boolean} hasGoals
 */
export function practiceKey(step, phase, pressed, values, hasGoals) {
  const moving = phase === "moving";
  switch (step) {
    case "press": return moving ? null : stepKey(step, values);
    case "watch": return moving ? "practice.watch" : stepKey("press", values);
    case "let_go": return moving || pressed ? stepKey(step, values) : null;
    case "stop": return stepKey(step, values);
    case "reach": return hasGoals ? "practice.reach" : "practice.reach_nothing";
    default: return null;
  }
}
