/**
 * A push that does not change ends, held or not: after the time that its person has set for one that goes on by itself,
 * and before the server would stop the arm. Somebody who holds a stick and a stick that is dead look alike.
 */

/** So long before is said that it ends, s. */
const SAID_S = 3;
/** A push that is held ends so long before the server's time, s, so that the arm stays enabled. */
const EARLY_S = 0.25;

/** @param {DriveInput} input @param {Connection} connection @param {Settings} settings @param {(ends: boolean) => void} [said] hears that a push ends or has ended */
export function attachLatchLimit(input, connection, settings, said = () => {}) {
  /** @type {ReturnType<typeof setTimeout>[]} */
  let timers = [];
  let held = "";
  input.addEventListener("change", () => {
    const { source, device, x, y, latched } = input;
    const now = source === null ? "" : `${source} ${device} ${latched || [x, y]}`;
    if (now === held) return;
    held = now;
    timers.forEach(clearTimeout);
    said(false);
    if (source === null) return;
    const mostS = connection.welcome?.latch_max_s ?? settings.values.latchS;
    const longestS = latched ? Math.min(settings.values.latchS, mostS) : mostS - EARLY_S;
    timers = [setTimeout(() => said(true), 1000 * (longestS - SAID_S)), setTimeout(() => {
      input.neutral();
      said(true);
    }, 1000 * longestS)];
  });
  input.addEventListener("dropped", () => said(false));
}
