/**
 * Gamepads, or any sticks that the browser takes for one: two axes drive, the buttons stop, enable and more, as the person
 * has chosen. Whichever is pushed drives, once it has been seen at rest: since it appeared, since Enable, and since all let go.
 */

import { setHidden, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { isGuessed, mappingOf, nameOf, stickOf } from "../settings/pads.js";
import { dialogIsOpen } from "./dialogs.js";
import { padLives } from "./pad_life.js";

/** @import {Actions} from "./keyboard.js" */
/** @import {Mapping} from "../settings/pads.js" */

const IDLE_MS = 100;
/** In the letters and the length that the server takes. */
const sentName = (/** @type {string} */ id) => id.replace(/[^\w ()./:-]/g, " ").slice(0, 80);

/** @param {PersonInput} input @param {Settings} settings @param {Pick<Scanner, "press">} scanner takes a button as a switch @param {Actions & {stop: () => void}} actions */
export function attachGamepad(input, settings, scanner, actions) {
  /** Says what the person must do about a gamepad. */
  const line = document.getElementById("unrested");
  /** By their index. @type {Map<number, {id: string, down: boolean[], drives: string}>} */
  const known = new Map();
  const isAlive = padLives();
  let flowed = false;

  const distrustAll = () => {
    for (const index of known.keys()) input.distrust("gamepad", index);
  };
  const lost = (/** @type {number} */ index) => {
    // It may have been the one whose button stops the arm.
    if (known.delete(index)) input.halt("gamepad_lost");
  };

  const poll = () => {
    const pads = [...navigator.getGamepads()].flatMap((pad) => (pad?.connected && isAlive(pad, performance.now()) ? [pad] : []));
    for (const [index, { id }] of known) {
      if (!pads.some((pad) => pad.index === index && pad.id === id)) lost(index);
    }
    if (input.flowing && !flowed) distrustAll();
    flowed = input.flowing;
    const [unrested, guessed] = [pads.filter(read), pads.filter((pad) => isGuessed(settings.values.pads, pad))];
    const about = unrested.length ? unrested : guessed;
    const name = about.map(nameOf).join(", ");
    if (!line) return;
    setHidden(line, !about.length);
    setText(line, about.length ? say(unrested.length ? "gamepad.unrested" : "gamepad.unknown", { name }) : "");
  };
  /** @param {Gamepad} pad @returns {boolean} whether it is pushed and does not count */
  const read = (pad) => {
    const { index, id } = pad;
    const mapping = mappingOf(settings.values.pads, pad);
    const pressed = pad.buttons.map((button) => button.pressed);
    const before = known.get(index);
    const drives = JSON.stringify(mapping);
    known.set(index, { id, down: pressed, drives });
    pressed.forEach((is, number) => {
      if (before && is !== Boolean(before.down[number])) act(mapping, number, is);
      // Of the buttons of one that appears only Stop counts: the others may be stuck.
      if (!before && is && mapping.uses[number] === "stop") actions.stop();
    });
    const [x, y] = stickOf(mapping, pad.axes);
    const rests = Math.hypot(x, y) <= Math.max(mapping.dead, settings.values.deadZone);
    if (before?.drives !== drives || Number.isNaN(x + y)) input.distrust("gamepad", index);
    if (!Number.isNaN(x + y)) input.hold("gamepad", rests ? 0 : x, rests ? 0 : y, false, index, sentName(id));
    return input.waits("gamepad", index);
  };
  const act = (/** @type {Mapping} */ { uses }, /** @type {number} */ number, /** @type {boolean} */ isDown) => {
    const use = uses[number];
    // While the settings ask which button is for what, a press is the answer.
    const asked = document.querySelector("[data-pad-asking]") !== null;
    if ((!asked && scanner.press(number, isDown)) || !isDown || !use) return;
    if (use === "stop" || !dialogIsOpen()) actions[use]?.();
  };

  window.addEventListener("gamepaddisconnected", (event) => lost(event.gamepad.index));
  input.addEventListener("dropped", distrustAll);
  // While inputs flow the pads are read with each of them; else often enough to notice a button.
  input.addEventListener("poll", poll);
  setInterval(() => {
    if (!input.flowing && !document.hidden) poll();
  }, IDLE_MS);
}
