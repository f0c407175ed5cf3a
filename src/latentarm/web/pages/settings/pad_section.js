/** The part of the settings where a gamepad's buttons and stick get their uses by being pressed. Behind a dialog nothing moves. */

import { byId, setHidden, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { idOf, mappingOf, nameOf, validMappings, withPush, withUse } from "./pads.js";

const LOOK_MS = 50;
/** So many looks the stick is watched at rest; a hand that is on it strays further than this. */
const [REST_LOOKS, AT_REST] = [15, 0.2];
const STICK = ["right", "up"];

/** @param {HTMLDialogElement} dialog @param {Settings} settings */
export function attachPadSection(dialog, settings) {
  const [live, part] = [byId("pad-live"), byId("pad")];
  /** The button of the page that asks. @type {HTMLElement | null} */
  let asks = null;
  let isAnswered = false;
  /** Of all axes. @type {number[][]} */
  let atRest = [];
  /** The gamepad that was pressed last, which of its buttons were down, and its axes when it was first seen. @type {{index: number, down: number[], first: number[]}} */
  let last = { index: -1, down: [], first: [] };

  const ask = (/** @type {HTMLElement | null} */ asker) => {
    delete asks?.dataset.padAsking;
    [asks, isAnswered, atRest] = [asker, false, []];
    if (asks) asks.dataset.padAsking = "yes";
  };
  /** The mapping with what is pressed now; null for nothing yet; undefined for a button that cannot be the answer, which ends the question. @param {string} use @param {Gamepad} pad @param {number[]} down */
  const answer = (use, pad, down) => {
    const mapping = mappingOf(settings.values.pads, pad);
    if (use === "others") return { ...mapping, uses: mapping.uses.map((one) => one || "stop") };
    const pressed = down.find((number) => pad.index === last.index && !last.down.includes(number));
    if (pressed !== undefined) return STICK.includes(use) ? undefined : withUse(mapping, /** @type {import("./pads.js").Use} */ (use), pressed);
    if (!STICK.includes(use)) return null;
    const hasStrayed = atRest.some((one) => one.some((value, axis) => Math.abs(value - pad.axes[axis]) > AT_REST));
    if (pad.index !== last.index || (hasStrayed && atRest.length < REST_LOOKS)) atRest = [];
    if (atRest.length === REST_LOOKS) return withPush(mapping, STICK.indexOf(use), atRest, pad.axes);
    atRest.push([...pad.axes]);
    return null;
  };
  const look = () => {
    const pads = [...navigator.getGamepads()].flatMap((pad) => (pad?.connected ? [pad] : []));
    const pad = pads.find(({ buttons }) => buttons.some(({ pressed }) => pressed)) ?? pads.find(({ index }) => index === last.index) ?? pads[0];
    setHidden(part, !pad);
    if (!pad) return setText(live, say("gamepad.none"));
    const down = pad.buttons.flatMap(({ pressed }, number) => (pressed ? [number] : []));
    const found = asks && !isAnswered ? answer(asks.dataset.use ?? "", pad, down) : null;
    isAnswered ||= found !== null;
    if (found) settings.change({ pads: validMappings({ ...settings.values.pads, [idOf(pad)]: found }) });
    // A press that answers does nothing else: it is the answer until it ends.
    else if (isAnswered && down.length === 0) ask(null);
    last = { index: pad.index, down, first: pad.index === last.index ? last.first : [...pad.axes] };
    const { uses, at } = mappingOf(settings.values.pads, pad);
    const words = (/** @type {number[]} */ buttons, /** @type {number[]} */ axes) => {
      const listed = (/** @type {number[]} */ all) => ({ numbers: all.map((number) => number + 1).join(", ") });
      const parts = [buttons.length && say("gamepad.button", listed(buttons)), axes.length && say("gamepad.axis", listed(axes))];
      return parts.filter(Boolean).join(", ") || say("gamepad.nothing");
    };
    const pushed = pad.axes.flatMap((value, axis) => (Math.abs(value - last.first[axis]) > AT_REST ? [axis] : []));
    setText(live, say("gamepad.live", { name: nameOf(pad), pressed: words(down, pushed) }));
    for (const asker of /** @type {NodeListOf<HTMLElement>} */ (part.querySelectorAll("[data-name]"))) {
      const [stick, use] = [STICK.indexOf(asker.dataset.use ?? ""), asker.dataset.name ?? ""];
      const what = words(uses.flatMap((one, number) => (one === asker.dataset.use ? [number] : [])), stick < 0 ? [] : [at[stick]]);
      const asking = stick < 0 ? "gamepad.ask_button" : atRest.length < REST_LOOKS ? "gamepad.ask_rest" : "gamepad.ask_push";
      setText(asker, say(asker === asks ? asking : "gamepad.is", { use, what }));
    }
  };

  part.addEventListener("click", ({ target }) => ask(target instanceof HTMLElement && target.dataset.use ? target : null));
  dialog.addEventListener("close", () => {
    ask(null);
    last.index = -1;
  });
  setInterval(() => dialog.open && look(), LOOK_MS);
}
