/** The list that scanning lights up, and what is in it: never nothing. */

import { byId, create, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { DIRECTION_NAMES } from "./deflection.js";
import { topmost, watchOpen } from "./dialogs.js";
import { attachHeldPointer } from "./held_pointer.js";
import { keyWords } from "./keys.js";
import { elementOf, pageControls } from "./page_controls.js";
import { Scanner } from "./scanner.js";
import { attachSpeech } from "./speech.js";
import { attachSwitchKeys } from "./switch_keys.js";
import { attachSwitchPlace } from "./switch_place.js";

/** How often the offered choices are checked, ms. */
const LOOK_MS = 100;
const LIT = "lit";

/** The four directions to choose from. @returns {Choice[]} */
export function directionChoices() {
  return DIRECTION_NAMES.map((id) => ({ id, label: say(`directions.${id}`) }));
}

/**
 * A group of choices. Its members are computed when it opens, because some lists are long; Back, and `always`, such as Stop, are
 * added to them. @param {string} id @param {string} label @param {() => Choice[]} inner @param {Choice[]} [always]
 */
export function groupOf(id, label, inner, always = []) {
  const back = { id: `${id}-back`, label: say("scanning.back"), back: true };
  return { id, label: say("scanning.group", { name: label }), inner: () => [...inner(), ...always, back] };
}

/**
 * @param {PersonInput} input
 * @param {Settings} settings
 * @param {() => void} stop
 * @param {(stops: Choice, group: Group) => Choice[]} offered what the page has to choose from now; Stop is added where it is missing
 */
export function attachScanning(input, settings, stop, offered) {
  const [list, help] = [byId("scan"), byId("scan-help")];
  const [press, next] = [byId("switch", HTMLButtonElement), byId("switch-next", HTMLButtonElement)];
  const scanner = new Scanner(input, settings);
  const speak = attachSpeech(settings, "speak");
  const place = attachSwitchPlace();
  const stops = { id: "stop", label: say("layout.stop"), act: stop };
  /** @type {Group} */
  const group = (id, label, inner) => groupOf(id, label, inner, [stops]);

  const paint = () => {
    list.replaceChildren(...scanner.choices.map(({ id, label }, index) => {
      const state = { ...(id === scanner.moving && { moving: "true" }), ...(id === scanner.ready && { ready: "true" }) };
      if (index !== scanner.lit) return create("li", { textContent: label, dataset: { choice: id, ...state } });
      return create("li", { textContent: label, ariaCurrent: "true", dataset: { choice: id, ...state, hint: hint() } });
    }));
    showLit();
    const label = scanner.choices[scanner.lit]?.label ?? "";
    speak(!scanner.on ? "" : scanner.moving === null ? label : say("scanning.says_moving", { direction: label }));
  };
  /** A long list has the lit choice in its middle, and the page stays where it is. */
  const showLit = () => {
    const lit = list.children[scanner.lit];
    if (lit) list.scrollTop += lit.getBoundingClientRect().top - list.getBoundingClientRect().top - (list.clientHeight - lit.clientHeight) / 2;
  };
  /** The effect of a press, above the name of the lit choice. */
  const hint = () => {
    if (scanner.moving !== null) return say(settings.values.switchMotion === "hold" ? "scanning.let_go" : "scanning.press_to_stop");
    if (scanner.ready !== null) return say("scanning.hold_to_move");
    return say(`scanning.hint_${scanner.style}`);
  };
  /** Of what is open above the page everything that can be pressed, else what the page offers. */
  const now = () => {
    const open = topmost();
    if (!open) return offered(stops, group);
    const close = { id: "close", label: say("scanning.back"), act: () => open.hidePopover() };
    return [...pageControls(open, group, open.id), ...(open.popover ? [close] : [])];
  };
  const offer = () => {
    if (scanner.on) {
      const choices = now();
      scanner.offer(choices.some(({ id }) => id === "stop") ? choices : [...choices, stops]);
    }
    light();
  };
  /** The page may have redrawn the lit element: look it up each time. */
  const light = () => {
    place(scanner.on, topmost());
    const choice = scanner.on ? scanner.choices[scanner.lit] : undefined;
    const lit = (choice?.row ?? [choice]).flatMap((one) => elementOf(one) ?? []);
    for (const other of [...document.getElementsByClassName(LIT)]) if (!lit.includes(/** @type {HTMLElement} */ (other))) other.classList.remove(LIT);
    if (lit.every((one) => one.classList.contains(LIT))) return;
    for (const one of lit) one.classList.add(LIT);
    lit[0].scrollIntoView({ block: "nearest" });
  };
  const explain = () => {
    const { switches, switchKey, nextKey, switchMotion } = settings.values;
    const keys = { switchKey: keyWords(switchKey), nextKey: keyWords(nextKey) };
    next.hidden = switches !== "2";
    setText(help, `${say(`scanning.${scanner.style}`, keys)} ${say(`scanning.motion_${switchMotion}`)}`);
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
  button(press, 0);
  button(next, 1);

  attachSwitchKeys(scanner, input, settings);
  window.addEventListener("pointerdown", () => (settings.byHand = true), { capture: true });
  scanner.addEventListener("change", () => {
    paint();
    light();
  });
  settings.addEventListener("change", explain);
  watchOpen(offer);
  setInterval(offer, LOOK_MS);
  explain();
  return scanner;
}
