/** Arrows or W A S D drive while they are held; Enter enables; G opens and closes the gripper; letters and digits can be turned off. */

import { DIRECTIONS } from "./deflection.js";

const { up, down, left, right } = DIRECTIONS;
/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowUp: up, ArrowDown: down, ArrowLeft: left, ArrowRight: right };
/** @type {Record<string, [number, number]>} */
const LETTERS = { KeyW: up, KeyS: down, KeyA: left, KeyD: right };

/** @typedef {{stop?: () => void, enable?: () => void, gripper?: () => void, nextMode?: () => void, axes?: (index: number) => void}} Actions */

/** @param {PersonInput} input @param {Settings} settings @param {Actions} actions */
export function attachKeyboard(input, settings, actions) {
  /** @type {Map<string, [number, number]>} */
  const held = new Map();

  const push = () => {
    const [x, y] = [0, 1].map((axis) => Math.sign([...held.values()].reduce((sum, direction) => sum + direction[axis], 0)));
    input.hold("keyboard", x, y);
  };
  const letGo = () => {
    held.clear();
    input.release("keyboard");
  };

  window.addEventListener("keydown", (event) => {
    // With a modifier it is the browser's or the system's, which may also swallow the key's release.
    if (event.ctrlKey || event.altKey || event.metaKey) {
      letGo();
      return;
    }
    if (isTaken(event.target, event.code, input.flowing)) return;
    const direction = ARROWS[event.code] ?? (settings.values.shortcuts ? LETTERS[event.code] : undefined);
    if (direction) {
      if (input.flowing) event.preventDefault();
      if (event.repeat) return;
      held.set(event.code, direction);
      push();
    } else if (!event.repeat) {
      act(event);
    }
  });
  const act = (/** @type {KeyboardEvent} */ event) => {
    if (event.code === "Enter" && !isInteractive(event.target)) actions.enable?.();
    if (!settings.values.shortcuts) return;
    if (event.code === "KeyM") actions.nextMode?.();
    if (event.code === "KeyG") actions.gripper?.();
    const digit = /^Digit([1-9])$/.exec(event.code);
    if (digit) actions.axes?.(Number(digit[1]) - 1);
  };
  window.addEventListener("click", unfocus);
  window.addEventListener("keyup", (event) => {
    if (held.delete(event.code)) push();
  });
  input.addEventListener("dropped", () => held.clear());
}

/** A pointer leaves no focus on the button that it presses, which Enter would press again; keys that press it leave it there. @param {MouseEvent} click */
export function unfocus({ detail, target }) {
  const button = detail > 0 && target instanceof Element ? target.closest("button") : null;
  if (button && button === document.activeElement) button.blur();
}

/** Whether the focused control wants this key for itself. @param {EventTarget | null} target @param {string} code @param {boolean} driving */
function isTaken(target, code, driving) {
  if (!(target instanceof HTMLElement)) return false;
  const typed = "textarea, select, input:not([type=radio], [type=checkbox], [type=button])";
  if (target.closest("dialog") || target.matches(typed)) return true;
  // Arrows choose among radio buttons; while the arm is enabled they drive it.
  return !driving && code.startsWith("Arrow") && target.matches("input[type=radio]");
}

/** Whether Enter means something to the focused control. @param {EventTarget | null} target */
function isInteractive(target) {
  const takers = "a, button, input:not([type=radio], [type=checkbox]), select, textarea, summary, dialog";
  return target instanceof HTMLElement && target.closest(takers) !== null;
}
