/** A trembling hand is steadied, a push is hardly delayed, and letting go is not. */

import assert from "node:assert/strict";
import { test } from "node:test";

import { TremorFilter } from "#pages/inputs/tremor.js";

const STEP_S = 0.02;
const STRENGTHS = ["light", "medium", "strong"];

/** What comes out of a push, 50 times a second. @param {string} strength @param {(nowS: number) => number} push */
function steadied(strength, push, untilS = 6) {
  const filter = new TremorFilter();
  const seen = [];
  for (let tick = 0; tick * STEP_S < untilS; tick += 1) seen.push(filter.steady(strength, push(tick * STEP_S), 0, tick * STEP_S)[0]);
  return seen;
}

/** How much of a tremor about a steady push is left, as a share of its size. */
function leftOf(strength, hertz, size = 0.15) {
  const late = steadied(strength, (nowS) => 0.6 + size * Math.sin(2 * Math.PI * hertz * nowS)).slice(150);
  return (Math.max(...late) - Math.min(...late)) / (2 * size);
}

/** When a full push has got to a share of itself, s. */
function delayTo(share, strength) {
  return STEP_S * steadied(strength, () => 1).findIndex((value) => value >= share);
}

/** The most that may be left at 4 and 8 Hz, and how long a step may take to its half and to nine tenths, s. */
const BOUNDS = { light: [0.6, 0.4, 0.04, 0.16], medium: [0.4, 0.25, 0.06, 0.3], strong: [0.25, 0.15, 0.12, 0.6] };

for (const strength of STRENGTHS) {
  test(`${strength}: a tremor of 4 to 8 Hz is weaker, and a push arrives soon`, (context) => {
    const [at4, at8, half, most] = BOUNDS[strength];
    const figures = {
      left4: leftOf(strength, 4), left6: leftOf(strength, 6), left8: leftOf(strength, 8),
      half: delayTo(0.5, strength), most: delayTo(0.9, strength),
    };
    context.diagnostic(`${strength} ${JSON.stringify(figures)}`);
    assert.ok(figures.left4 <= at4, JSON.stringify(figures));
    assert.ok(figures.left8 <= at8, JSON.stringify(figures));
    assert.ok(figures.half <= half, JSON.stringify(figures));
    assert.ok(figures.most <= most, JSON.stringify(figures));
  });

  test(`${strength}: letting go counts at once, and what comes next begins at rest`, () => {
    const filter = new TremorFilter();
    for (let tick = 0; tick < 100; tick += 1) filter.steady(strength, 1, -1, tick * STEP_S);
    assert.deepEqual(filter.steady(strength, 0, 0, 2), [0, 0]);
    const [again] = filter.steady(strength, 1, 0, 2.02);
    assert.ok(again < 0.5);
  });

  test(`${strength}: it never overshoots, whatever is pushed`, () => {
    let seed = 7;
    const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
    let [low, high] = [0, 0];
    const filter = new TremorFilter();
    for (let tick = 0; tick < 2000; tick += 1) {
      const push = random() < 0.1 ? 0.001 + random() : -random();
      [low, high] = [Math.min(low, push), Math.max(high, push)];
      const [value] = filter.steady(strength, push, 0.5, tick * STEP_S);
      assert.ok(value >= low && value <= high);
    }
    let before = 0;
    for (const value of steadied(strength, () => 1)) {
      assert.ok(value >= before && value <= 1);
      before = value;
    }
  });
}

test("off changes nothing", () => {
  assert.deepEqual(steadied("off", Math.sin).slice(1), Array.from({ length: 299 }, (_, at) => Math.sin((at + 1) * STEP_S)));
});
