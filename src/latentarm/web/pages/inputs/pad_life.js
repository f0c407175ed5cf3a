/**
 * Which of the gamepads that the browser lists are alive.
 *
 * By the Gamepad API `timestamp` moves with every report of the device. Many devices report all the time: when their time
 * and values stand still, they are gone. Others report changes alone, and some browsers have no time, or move it without a
 * report: of these a dead one looks like a held stick, which ends after 10 s.
 */

/** So many reports without a change, and no pause between them, show that a gamepad reports all the time. */
const STEADY_REPORTS = 25;
/** Radio may lose some reports in a row, ms. */
const GONE_MS = 100;
/** Of the time between two looks so much counts, ms: a page that hung has seen nothing. */
const LOOK_MS = 50;

/** To be asked again and again. @returns {(pad: Gamepad, nowMs: number) => boolean} */
export function padLives() {
  /** @type {Map<string, {seen: string, timestamp: number, lookedMs: number, stillMs: number, reports: number}>} */
  const lives = new Map();
  return ({ index, id, timestamp, axes, buttons }, nowMs) => {
    const seen = [...axes, ...buttons.map(({ pressed, value }) => `${pressed} ${value}`)].join();
    const was = lives.get(`${index} ${id}`);
    const [changed, reported] = [seen !== was?.seen, timestamp !== was?.timestamp];
    const stillMs = was && !changed && !reported ? was.stillMs + Math.min(nowMs - was.lookedMs, LOOK_MS) : 0;
    const reports = (was?.reports ?? 0) + Number(reported && !changed);
    const isSteady = reports >= STEADY_REPORTS;
    lives.set(`${index} ${id}`, { seen, timestamp, lookedMs: nowMs, stillMs, reports: stillMs < GONE_MS || isSteady ? reports : 0 });
    return stillMs < GONE_MS || !isSteady;
  };
}
