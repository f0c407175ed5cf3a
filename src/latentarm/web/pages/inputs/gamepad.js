/** A gamepad, or any stick that the browser takes for one: its first two axes drive, its buttons stop, enable and move the gripper. */

/** @import {PersonInput} from "./deflection.js" */
/** @import {Settings} from "../settings/settings.js" */

const ENABLE_BUTTON = 0;
/** The first of these that does not stop moves the gripper. */
const GRIPPER_BUTTONS = [2, 3];
/** On its shoulders: another mode, or another pair of directions. */
const MODE_BUTTONS = [4, 5];
/** A stick that rests a little off its middle is at rest. */
const REST = 0.08;
const IDLE_MS = 100;

/**
 * @param {PersonInput} input
 * @param {Settings} settings
 * @param {{enable: () => void, stop: () => void, gripper: () => void, nextMode: () => void, press: (number: number, down: boolean) => boolean}} actions
 *   `press` takes a button as a switch, where scanning is on, and says whether it did.
 */
export function attachGamepad(input, settings, actions) {
  /** @type {boolean[]} */
  let down = [];
  /** @type {number | null} */
  let driving = null;

  const lost = () => {
    driving = null;
    down = [];
    input.halt("gamepad_lost");
  };

  const poll = () => {
    const pads = navigator.getGamepads();
    const pad = driving === null ? [...pads].find((one) => one?.connected) : pads[driving];
    if (!pad || !pad.connected) {
      if (driving !== null) lost();
      return;
    }
    driving = pad.index;
    const pressed = pad.buttons.map((button) => button.pressed);
    pressed.forEach((is, number) => {
      if (is !== Boolean(down[number])) act(number, is);
    });
    down = pressed;
    const [x, y] = [pad.axes[0] ?? 0, pad.axes[1] ?? 0];
    const resting = !(Math.hypot(x, y) > REST);
    if (!resting || input.source === "gamepad") input.hold("gamepad", resting ? 0 : x, resting ? 0 : -y);
  };
  const act = (/** @type {number} */ number, /** @type {boolean} */ isDown) => {
    const stops = settings.values.gamepadStop;
    if (actions.press(number, isDown) || !isDown) return;
    if (stops === "any" || Number(stops) === number) actions.stop();
    else if (number === ENABLE_BUTTON) actions.enable();
    else if (number === GRIPPER_BUTTONS.find((one) => one !== Number(stops))) actions.gripper();
    else if (MODE_BUTTONS.includes(number)) actions.nextMode();
  };

  window.addEventListener("gamepaddisconnected", (event) => {
    if (event.gamepad.index === driving) lost();
  });
  // While inputs flow the pad is read with each of them; else often enough to notice a button.
  input.addEventListener("poll", poll);
  setInterval(() => {
    if (!input.flowing && !document.hidden) poll();
  }, IDLE_MS);
}
