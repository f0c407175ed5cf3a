/**
 * Gamepads, or any sticks that the browser takes for one: the first two axes drive, the buttons stop, enable and move the
 * gripper. Whichever is pushed drives, once it has been seen at rest: since it appeared, since Enable, and since all let go.
 */

import { setHidden, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** @import {PersonInput} from "./deflection.js" */
/** @import {Settings} from "../settings/settings.js" */

const ENABLE_BUTTON = 0;
/** The first of these that does not stop moves the gripper. */
const GRIPPER_BUTTONS = [2, 3];
/** On its shoulders: another mode, or another pair of directions. */
const MODE_BUTTONS = [4, 5];
/** A stick that rests a little off its middle is at rest, even where its person ignores no small pushes. */
const REST = 0.08;
const IDLE_MS = 100;

/**
 * @param {PersonInput} input
 * @param {Settings} settings
 * @param {{enable: () => void, stop: () => void, gripper: () => void, nextMode: () => void, press: (number: number, down: boolean) => boolean}} actions
 *   `press` takes a button as a switch, where scanning is on, and says whether it did.
 * @param {(names: string[]) => void} [unrested] told which gamepads are pushed and must be let go before they count
 */
export function attachGamepad(input, settings, actions, unrested = () => {}) {
  /** By their index. @type {Map<number, {id: string, down: boolean[]}>} */
  const known = new Map();
  let flowed = false;

  const distrustAll = () => {
    for (const index of known.keys()) input.distrust("gamepad", index);
  };
  const lost = (/** @type {number} */ index) => {
    // It may have been the one whose button stops the arm.
    if (known.delete(index)) input.halt("gamepad_lost");
  };

  const poll = () => {
    const pads = [...navigator.getGamepads()].filter((pad) => pad !== null && pad.connected);
    for (const [index, { id }] of known) {
      if (!pads.some((pad) => pad?.index === index && pad.id === id)) lost(index);
    }
    if (input.flowing && !flowed) distrustAll();
    flowed = input.flowing;
    unrested(pads.flatMap((pad) => (pad && read(pad) ? [pad.id] : [])));
  };
  /** @param {Gamepad} pad @returns {boolean} whether it is pushed and does not count */
  const read = (pad) => {
    const { index, id } = pad;
    const pressed = pad.buttons.map((button) => button.pressed);
    const before = known.get(index);
    known.set(index, { id, down: pressed });
    pressed.forEach((is, number) => {
      if (before && is !== Boolean(before.down[number])) act(number, is);
      // Of the buttons of one that appears only Stop counts: the others may be stuck.
      if (!before && is && stops(number)) actions.stop();
    });
    const [x, y] = [pad.axes[0] ?? 0, pad.axes[1] ?? 0].map((axis) => Math.min(Math.max(axis, -1), 1));
    const rests = Math.hypot(x, y) <= Math.max(REST, settings.values.deadZone);
    if (!before || Number.isNaN(x + y)) input.distrust("gamepad", index);
    if (!Number.isNaN(x + y)) input.hold("gamepad", rests ? 0 : x, rests ? 0 : -y, false, index);
    return input.waits("gamepad", index);
  };
  const stops = (/** @type {number} */ number) => ["any", String(number)].includes(settings.values.gamepadStop);
  const act = (/** @type {number} */ number, /** @type {boolean} */ isDown) => {
    if (actions.press(number, isDown) || !isDown) return;
    if (stops(number)) actions.stop();
    else if (number === ENABLE_BUTTON) actions.enable();
    else if (number === GRIPPER_BUTTONS.find((one) => !stops(one))) actions.gripper();
    else if (MODE_BUTTONS.includes(number)) actions.nextMode();
  };

  window.addEventListener("gamepaddisconnected", (event) => lost(event.gamepad.index));
  input.addEventListener("dropped", distrustAll);
  // While inputs flow the pads are read with each of them; else often enough to notice a button.
  input.addEventListener("poll", poll);
  setInterval(() => {
    if (!input.flowing && !document.hidden) poll();
  }, IDLE_MS);
}

/** Names the gamepads that count for nothing until they were let go, and says what to do. @param {HTMLElement} line @param {string[]} names */
export function sayUnrested(line, names) {
  setHidden(line, names.length === 0);
  if (names.length) setText(line, say("gamepad.unrested", { name: names.join(", ") }));
}
