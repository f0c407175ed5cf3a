/**
 * A motion that goes on by itself begins and ends with presses. Two of these that come closer together than a person can
 * mean them are the switch's or the button's own: the arm stops.
 */

import { REACTION_MS } from "./switch_timing.js";

/** @param {PersonInput} input */
export function attachChatterGuard(input) {
  let latched = false;
  let turnedAt = -Infinity;
  input.addEventListener("turned", () => {
    const ended = input.source === null && latched;
    latched = input.latched && input.source !== null;
    if (!latched && !ended) return;
    const tooSoon = performance.now() - turnedAt < REACTION_MS;
    turnedAt = performance.now();
    if (tooSoon) input.halt("switch_chatters");
  });
}
