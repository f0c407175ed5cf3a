/** Arrows or W A S D drive while they are held; Enter enables; letters and digits can be turned off. */

/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
/** @type {Record<string, [number, number]>} */
const LETTERS = { KeyW: [0, 1], KeyS: [0, -1], KeyA: [-1, 0], KeyD: [1, 0] };

/**
 * @param {import("./inputs.js").Inputs | import("../personalise/answering.js").Answering} inputs
 * @param {import("../settings/settings.js").Settings} settings
 * @param {{enable: () => void, nextMode: () => void, axes: (index: number) => void}} actions
 */
export function attachKeyboard(inputs, settings, actions) {
  /** @type {Map<string, [number, number]>} */
  const down = new Map();

  const push = () => {
    let [x, y] = [0, 0];
    for (const [right, up] of down.values()) {
      x += right;
      y += up;
    }
    inputs.hold("keyboard", Math.sign(x), Math.sign(y));
  };
  const letGo = () => {
    down.clear();
    inputs.release("keyboard");
  };

  window.addEventListener("keydown", (event) => {
    // With a modifier it is the browser's or the system's, which may also swallow the key's release.
    if (event.ctrlKey || event.altKey || event.metaKey) {
      letGo();
      return;
    }
    if (isTaken(event.target, event.code, inputs.flowing)) return;
    const direction = ARROWS[event.code] ?? (settings.values.shortcuts ? LETTERS[event.code] : undefined);
    if (direction) {
      if (inputs.flowing) event.preventDefault();
      if (event.repeat) return;
      down.set(event.code, direction);
      push();
    } else if (!event.repeat) {
      act(event);
    }
  });
  const act = (/** @type {KeyboardEvent} */ event) => {
    if (event.code === "Enter" && !isInteractive(event.target)) actions.enable();
    if (!settings.values.shortcuts) return;
    if (event.code === "KeyM") actions.nextMode();
    const digit = /^Digit([1-9])$/.exec(event.code);
    if (digit) actions.axes(Number(digit[1]) - 1);
  };
  window.addEventListener("keyup", (event) => {
    if (down.delete(event.code)) push();
  });
  inputs.addEventListener("dropped", () => down.clear());
}

/** Whether the focused control wants this key for itself. @param {EventTarget | null} target @param {string} code @param {boolean} driving */
function isTaken(target, code, driving) {
  if (!(target instanceof HTMLElement)) return false;
  if (target.closest("dialog")) return true;
  if (target.matches("textarea, select, input:not([type=radio], [type=checkbox], [type=button])")) return true;
  // Arrows choose among radio buttons; while the arm is enabled they drive it.
  return !driving && code.startsWith("Arrow") && target.matches("input[type=radio]");
}

/** Whether Enter means something to the focused control. @param {EventTarget | null} target */
export function isInteractive(target) {
  const takers = "a, button, input:not([type=radio], [type=checkbox]), select, textarea, summary, dialog";
  return target instanceof HTMLElement && target.closest(takers) !== null;
}
