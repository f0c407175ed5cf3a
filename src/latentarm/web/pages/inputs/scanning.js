/** The list that scanning lights up, the switches' buttons and their keys. */

import { create, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { DIRECTION_NAMES } from "./deflection.js";
import { attachHeldPointer } from "./held_pointer.js";
import { isInteractive } from "./keyboard.js";
import { keyWords } from "./keys.js";
import { Scanner } from "./scanner.js";
import { attachSpeech } from "./speech.js";

/** @import {PersonInput} from "./deflection.js" */
/** @import {Choice} from "./scanner.js" */
/** @import {Settings} from "../settings/settings.js" */

/** How often the offered choices are checked, ms. */
const LOOK_MS = 100;

/** The four directions to choose from. @returns {Choice[]} */
export function directionChoices() {
  return DIRECTION_NAMES.map((id) => ({ id, label: say(`directions.${id}`) }));
}

/**
 * A choice that opens others. Stop, where it is given, and the way back stand among them.
 *
 * @param {string} id
 * @param {string} label
 * @param {() => Choice[]} inner asked for only while it is open: some lists are long
 * @param {Choice[]} [always] what must be in reach from there too
 * @returns {Choice}
 */
export function groupOf(id, label, inner, always = []) {
  const back = { id: `${id}-back`, label: say("scanning.back"), back: true };
  return { id, label: say("scanning.group", { name: label }), inner: () => [...inner(), ...always, back] };
}

/**
 * @param {{list: HTMLElement, press: HTMLButtonElement, next: HTMLButtonElement, help: HTMLElement}} parts
 * @param {PersonInput} input
 * @param {Settings} settings
 * @param {() => Choice[]} offered what there is to choose from now
 * @param {(target: EventTarget | null) => boolean} [keeps] whether a focused control keeps its keys; by default while
 *   nothing could move
 */
export function attachScanning(
  parts, input, settings, offered, keeps = (target) => isInteractive(target) && (!input.live || inDialog(target)),
) {
  const scanner = new Scanner(input, settings);
  const speak = attachSpeech(settings);

  const paint = () => {
    parts.list.replaceChildren(...scanner.choices.map((choice, index) => {
      const item = create("li", { textContent: choice.label });
      item.dataset.choice = choice.id;
      if (choice.id === scanner.moving) item.dataset.moving = "true";
      if (choice.id === scanner.ready) item.dataset.ready = "true";
      if (index === scanner.lit) {
        item.setAttribute("aria-current", "true");
        item.dataset.hint = hint();
      }
      return item;
    }));
    const label = scanner.choices[scanner.lit]?.label ?? "";
    speak(!scanner.on ? "" : scanner.moving === null ? label : say("scanning.says_moving", { direction: label }));
  };
  /** The effect of a press, above the name of the lit choice. */
  const hint = () => {
    if (scanner.moving !== null) return say(settings.values.switchMotion === "hold" ? "scanning.let_go" : "scanning.press_to_stop");
    if (scanner.ready !== null) return say("scanning.hold_to_move");
    return say(`scanning.hint_${scanner.style}`);
  };
  const offer = () => {
    if (scanner.on) scanner.offer(offered());
  };
  const explain = () => {
    const { switches, switchKey, nextKey, switchMotion } = settings.values;
    const keys = { switchKey: keyWords(switchKey), nextKey: keyWords(nextKey) };
    parts.next.hidden = switches !== "2";
    setText(parts.help, `${say(`scanning.${scanner.style}`, keys)} ${say(`scanning.motion_${switchMotion}`)}`);
    offer();
    paint();
  };
  const button = (/** @type {HTMLButtonElement} */ element, /** @type {number} */ number) => {
    const lost = () => scanner.lost();
    attachHeldPointer(element, {
      begins: () => {
        scanner.press(number, true);
        return true;
      },
      ends: () => scanner.press(number, false),
      // Its choice was lit some time ago.
      missed: lost,
      lost,
    });
    // A click without a pointer comes from a screen reader: there is nothing to hold.
    element.addEventListener("click", (event) => {
      if (event.detail === 0) scanner.tap(number);
    });
  };
  button(parts.press, 0);
  button(parts.next, 1);

  const switchOf = (/** @type {string} */ code) => [settings.values.switchKey, settings.values.nextKey].indexOf(code);
  /** Keys that are down as switches. @type {Map<string, number>} */
  const held = new Map();
  window.addEventListener("keydown", (event) => {
    const number = switchOf(event.code);
    if (number < 0 || !scanner.on || number >= Number(settings.values.switches)) return;
    if (event.target !== parts.press && event.target !== parts.next && keeps(event.target)) return;
    // Before the keyboard's own meaning of the key, and before the click that Enter would make of it.
    event.preventDefault();
    event.stopImmediatePropagation();
    if (event.repeat) return;
    held.set(event.code, number);
    scanner.press(number, true);
  }, { capture: true });
  window.addEventListener("keyup", (event) => {
    const number = held.get(event.code);
    if (number === undefined) return;
    held.delete(event.code);
    event.preventDefault();
    scanner.press(number, false);
  }, { capture: true });
  window.addEventListener("blur", () => held.clear());

  scanner.addEventListener("change", paint);
  settings.addEventListener("change", explain);
  setInterval(offer, LOOK_MS);
  explain();
  return scanner;
}

/** @param {EventTarget | null} target */
function inDialog(target) {
  return target instanceof HTMLElement && target.closest("dialog") !== null;
}
