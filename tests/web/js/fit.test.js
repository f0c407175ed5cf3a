/** Check the fit: what is proposed follows from what was measured, whatever that is, and nothing on the page can move an arm. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { beforeEach, test } from "node:test";

import { Hold, Trials } from "#pages/fit/exercises.js";
import { acceptFor, deadZoneFor, dwellFor, quantile, reachFor, releaseFor, shakingOf, tremorFor } from "#pages/fit/measures.js";
import { changes, findingsOf, proposals, textsOf } from "#pages/fit/results.js";
import { shape } from "#pages/inputs/shaping.js";
import { TremorFilter } from "#pages/inputs/tremor.js";
import { DEFAULTS, Settings } from "#pages/settings/settings.js";
import { newBrowser } from "./browser.js";

const TIMES = 100;
const TICK_S = 0.02;

beforeEach(() => {
  newBrowser().document.documentElement = { lang: "en" };
});

/** The same numbers on every computer. @param {number} seed */
function drawing(seed) {
  let state = seed + 1;
  return (low = 0, high = 1) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return low + ((high - low) * state) / 2 ** 32;
  };
}

/** A hold of a hand: a place, a drift, a tremor, noise and jerks; looked at as late as a busy page looks. */
function signal(draw, most = 0.6, seconds = 6) {
  const [x, y, slide, size, hz, noise] = [draw(-most, most), draw(-most, most), draw(-0.02, 0.02), draw(0, 0.2), draw(3, 12), draw(0, 0.1)];
  const samples = [];
  for (let at = 0; at < seconds; at += TICK_S * draw(1, 2)) {
    const jerk = draw() < 0.003 ? draw(-1, 1) : 0;
    const sway = size * Math.sin(2 * Math.PI * hz * at);
    samples.push([x + slide * at + sway + draw(-noise, noise) + jerk, y - sway / 2 + draw(-noise, noise), at].map((one, axis) => (axis < 2 ? Math.min(Math.max(one, -1), 1) : one)));
  }
  return samples;
}

const wave = (far, size, hz, seconds = 3) =>
  Array.from({ length: seconds / TICK_S }, (_, index) => [far + size * Math.sin(2 * Math.PI * hz * index * TICK_S), 0, index * TICK_S]);

for (const most of [0.05, 0.15, 0.6]) {
  test(`the dead zone covers a rest within ${most}, or is the largest that there is`, () => {
    for (let seed = 0; seed < TIMES; seed += 1) {
      const rest = signal(drawing(seed), most);
      const deadZone = deadZoneFor(rest);
      const settled = rest.filter(([, , at]) => at >= 1);
      const still = settled.filter(([x, y]) => shape({ ...DEFAULTS, deadZone }, x, y).every((one) => one === 0));
      assert.ok(deadZone >= 0.05 && deadZone <= 0.3);
      assert.ok(still.length >= 0.95 * settled.length || deadZone === 0.3, `seed ${seed}`);
    }
  });
}

test("how often and how far a hand shakes is found, wherever it holds the stick", () => {
  for (let seed = 0; seed < TIMES; seed += 1) {
    const draw = drawing(seed);
    const [far, size, hz] = [draw(-0.8, 0.8), draw(0.02, 0.2), draw(3.5, 11)];
    const found = shakingOf(wave(far, size, hz));
    assert.ok(Math.abs(found.hz - hz) < 0.3 && Math.abs(found.size - size) < 0.1 * size, `${hz} Hz, ${size}: ${JSON.stringify(found)}`);
  }
  assert.ok(shakingOf(wave(0.7, 0, 5)).size < 0.001);
});

test("the steadying that is proposed steadies, and a weaker one would not", () => {
  const strengths = ["off", "light", "medium", "strong"];
  const proposed = new Set();
  for (let seed = 0; seed < TIMES / 2; seed += 1) {
    const draw = drawing(seed);
    const hold = wave(draw(0.3, 0.8), draw(0, 0.15), draw(4, 10));
    const left = (strength) => {
      const filter = new TremorFilter();
      return shakingOf(hold.map(([x, y, at]) => [...filter.steady(strength, x, y, at), at])).size;
    };
    const strength = tremorFor([hold]);
    proposed.add(strength);
    assert.ok(strength === "strong" || left(strength) <= 0.03, `seed ${seed}`);
    for (const weaker of strengths.slice(0, strengths.indexOf(strength))) assert.ok(left(weaker) > 0.03);
  }
  assert.equal(proposed.size, strengths.length);
});

test("with the proposed reach the most comfortable push is full in each direction, and none is more than full", () => {
  for (let seed = 0; seed < TIMES; seed += 1) {
    const draw = drawing(seed);
    const ranges = Array.from({ length: 4 }, () => draw(0.4, 1));
    const values = { ...DEFAULTS, sensitivity: 1, deadZone: draw(0, 0.3), reach: reachFor(ranges) };
    for (const range of ranges) assert.ok(Math.abs(shape(values, range, 0)[0] - 1) < 1e-9);
    const pushed = shape(values, draw(-1, 1), draw(-1, 1));
    assert.ok(pushed.every((one) => Math.abs(one) <= 1));
  }
  assert.equal(reachFor([0.1, 0.9, 0.9, 0.9]), 0.4);
  assert.equal(reachFor([0.8, 0.8, 0.8]), undefined);
});

test("a choice is lit no shorter than nine of ten presses take", () => {
  for (let seed = 0; seed < TIMES; seed += 1) {
    const draw = drawing(seed);
    const reactions = Array.from({ length: 6 + seed % 10 }, () => draw(0.2, 1) ** draw(-1.5, 1));
    const dwell = dwellFor(reactions);
    assert.ok(dwell === undefined || (dwell >= quantile(reactions, 0.9) && dwell >= 0.4 && dwell <= 5), `seed ${seed}`);
  }
  assert.equal(dwellFor(Array(8).fill(6)), undefined);
});

test("every press counts with the time that it must be held, and no second one too soon", () => {
  for (let seed = 0; seed < TIMES; seed += 1) {
    const draw = drawing(seed);
    const holds = Array.from({ length: 8 }, () => draw(0.3, 0.5));
    assert.ok(acceptFor([...holds, 0.02], 0.05) < Math.min(...holds));
    assert.ok(acceptFor(holds, 2) < Math.min(...holds));
    const doubles = [draw(0, 0.5), draw(0, 0.5)];
    assert.ok(releaseFor(doubles, 0.2, 8) >= Math.max(...doubles));
  }
});

test("too few presses, and a rest that was too short, propose nothing", () => {
  for (let few = 0; few < 6; few += 1) {
    const some = Array(few).fill(0.3);
    assert.deepEqual([dwellFor(some), acceptFor(some, 0.05), releaseFor([0.3], 0.2, few)], [undefined, undefined, undefined]);
  }
  const short = wave(0.1, 0.1, 5, 1.5);
  assert.deepEqual([deadZoneFor(short), tremorFor([short]), deadZoneFor([])], [undefined, undefined, undefined]);
  assert.deepEqual(findingsOf([], [], DEFAULTS), []);
});

test("a hold counts towards its direction only, beyond what the hand does at rest, and begins anew after a gap", () => {
  const rest = new Hold(null, null);
  for (let at = 0; at < 7; at += TICK_S) rest.see([0.3, 0], at);
  assert.equal(rest.share, 1);
  const right = new Hold("right", rest);
  const seen = (push, from, to) => {
    for (let at = from; at < to; at += TICK_S) right.see(push, at);
    return right.share;
  };
  assert.equal(seen([0.33, 0], 10, 14), 0);
  assert.equal(seen([0.5, 0.6], 14, 18), 0);
  assert.ok(seen([0.6, 0.1], 18, 20) > 0.5);
  assert.ok(seen([0.6, 0.1], 20.5, 21) < 0.2);
  assert.equal(seen([NaN, 0], 21, 22), 0);
  assert.equal(seen([0.6, 0.1], 22, 26), 1);
});

test("of a switch it is known what was right, early and late, and how long each press took", () => {
  const trials = new Trials("auto");
  let at = 0;
  /** The light goes on every second; the person presses after a while, and the scan takes what is lit then. */
  for (let trial = 0; trial < 8; trial += 1) {
    const named = Number(trials.named) - 1;
    for (let index = 0; index <= named; index += 1) trials.lit(index, (at += 1));
    const after = trial === 0 ? 1.2 : 0.6;
    if (trial === 0) trials.lit(named + 1, at + 1);
    trials.pressed(true, at + after);
    trials.pressed(false, at + after + 0.1);
    if (trial === 3) {
      trials.pressed(true, at + after + 0.3);
      trials.pressed(false, at + after + 0.4);
    }
    trials.took(trial === 0 ? named + 1 : named);
    at += 3;
  }
  assert.equal(trials.share, 1);
  assert.deepEqual(trials.counts, { right: 7, early: 0, late: 1 });
  assert.deepEqual(trials.reactions.map((one) => one.toFixed(1)), ["1.2", ...Array(7).fill("0.6")]);
  assert.deepEqual(trials.doubles.map((one) => one.toFixed(1)), ["0.2"]);
  assert.ok(dwellFor(trials.reactions) >= 1.2);
});

test("a computer is quick where four of five presses are seen in time", () => {
  const why = (...delays) => findingsOf([], delays, DEFAULTS)[0].why;
  assert.equal(why(30, 40, 50, 60, 900), "fit.quick");
  assert.equal(why(30, 40, 50, 400, 900), "fit.slow");
});

test("a choice is not lit shorter for who takes the wrong one", () => {
  const trials = Object.assign(new Trials("auto"), { done: 8, reactions: Array(8).fill(0.4) });
  const dwell = (right) => proposals(findingsOf([Object.assign(trials, { counts: { right, early: 8 - right, late: 0 } })], [], DEFAULTS), DEFAULTS).dwellS;
  assert.equal(dwell(8), 0.7);
  assert.equal(dwell(5), undefined);
});

test("with two switches nobody waits for the light, and no time is proposed for it", () => {
  const trials = new Trials("two");
  for (let at = 0; at < 16; at += 2) {
    trials.lit(Number(trials.named) - 1, at);
    trials.pressed(true, at + 1);
    trials.pressed(false, at + 1.1);
    trials.took(Number(trials.named) - 1);
  }
  assert.ok(!("dwellS" in proposals(findingsOf([trials], [], DEFAULTS), DEFAULTS)));
});

test("each finding says what was measured, today's setting, the proposed one and why; what has changed is said with its date", () => {
  const holds = [null, "right", "up", "left", "down"].map((towards, index, all) => {
    const hold = new Hold(towards, null);
    const [x, y] = [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]][index];
    hold.samples = wave(0, 0, 5, all ? 7 : 0).map(([, , at]) => [0.8 * x + 0.09 * Number(!towards), 0.8 * y, at]);
    return hold;
  });
  const findings = findingsOf(holds, [20, 30, 40], { ...DEFAULTS, deadZone: 0.05 });
  const texts = findings.map((one) => textsOf(one, { ...DEFAULTS, deadZone: 0.05 }));
  assert.deepEqual(texts[0].slice(0, 3), ["Drift at rest", "9 %", "Ignore small pushes: 5 % today, 10 % proposed"]);
  assert.deepEqual(proposals(findings, { ...DEFAULTS, deadZone: 0.05 }), { deadZone: 0.1, reach: 0.8 });
  for (const [name, measured, , why] of texts) assert.ok(name && measured && why);
  const before = { at: Date.UTC(2026, 10, 3), drift: 0.04, shaking: 0, reach: 0.8, speed: 31 };
  const [since, ...sentences] = changes(findings, before);
  assert.match(since, /November 3, 2026|3 November 2026/);
  assert.deepEqual(sentences, ["Drift at rest went from 4 % to 9 %."]);
  assert.match(changes(findings, { ...before, drift: 0.085 })[0], /^Little has changed since/);
  assert.equal(changes(findings, undefined).length, 1);
});

test("what was measured is kept with the settings, and stays where the settings are reset", () => {
  const settings = new Settings();
  settings.change({ fit: { stick: { at: 5, drift: 0.04 } }, deadZone: 0.3 });
  settings.reset();
  assert.deepEqual([settings.values.fit, settings.values.deadZone], [{ stick: { at: 5, drift: 0.04 } }, DEFAULTS.deadZone]);
  for (const fit of [null, "x", { stick: null }, { stick: { drift: 1 } }, { stick: { at: "now" } }]) {
    settings.take({ fit });
    assert.deepEqual(settings.values.fit, {});
  }
});

test("nothing that the page loads for it sends an input or enables an arm", () => {
  const root = new URL("../../../src/latentarm/web/pages/fit/fit.js", import.meta.url);
  const texts = new Map();
  const walk = (url) => {
    if (texts.has(url.href) || url.href.includes("/three/")) return;
    const text = readFileSync(url, "utf8");
    texts.set(url.href, text);
    for (const [, path] of text.matchAll(/^import .*?"([^"]+)";$|import\("([^"]+)"\)/gm)) if (path) walk(new URL(path, url));
  };
  walk(root);
  assert.ok(texts.size > 40);
  for (const [href, text] of texts) {
    if (href.endsWith("connection/connection.js")) continue;
    assert.doesNotMatch(text, /sendInput\(|type: "(input|enable|mode|return|go_to|personalise|try_alignment)"/, href);
  }
});
