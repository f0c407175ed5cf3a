import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { mappingOf, nameOf, stickOf, validMappings, withPush, withUse } from "#pages/settings/pads.js";
import { Settings } from "#pages/settings/settings.js";
import { newBrowser } from "./browser.js";

const padOf = (fields = {}) => ({ id: "a", mapping: "", axes: [0, 0, -1, 0], buttons: Array.from({ length: 4 }, () => ({ pressed: false })), ...fields });
const still = (axes, times = 15) => Array.from({ length: times }, () => axes);

let fakes;
beforeEach(() => {
  fakes = newBrowser();
});

test("Stop is on some button whatever is chosen, and a button has one use", () => {
  let mapping = mappingOf({}, padOf());
  let seed = 1;
  const chance = (most) => (seed = (seed * 16807) % 2147483647) % most;
  for (let turn = 0; turn < 10_000; turn += 1) {
    const [use, number] = [["stop", "enable", "gripper", "nextMode"][chance(4)], chance(4)];
    const wanted = withUse(mapping, use, number);
    if (wanted === undefined) {
      assert.deepEqual([mapping.uses.filter((one) => one === "stop").length, mapping.uses[number]], [1, "stop"]);
      continue;
    }
    mapping = wanted;
    assert.equal(mapping.uses[number], use);
    assert.ok(mapping.uses.includes("stop"));
    assert.deepEqual(validMappings({ a: mapping }), { a: mapping });
  }
});

test("the axis that is pushed is found, with its direction and where it rests", () => {
  const atRest = still([0, 0.1, -1, -0.2]);
  const right = withPush(mappingOf({}, padOf()), 0, atRest, [0, 0.1, -1, -0.95]);
  const both = withPush(right, 1, atRest, [0, 1, -1, -0.2]);
  assert.deepEqual([both.at, both.way], [[3, 1], [-1, 1]]);
  const stick = (axes) => stickOf(both, axes).map((value) => Math.round(100 * value) / 100 + 0);
  assert.deepEqual(stick([0, 0.1, 1, -0.2]), [0, 0]);
  assert.deepEqual(stick([0, 1, -1, -1]), [1, 1]);
  assert.deepEqual(stick([0, -1, -1, 1]), [-1, -1]);
});

test("whichever axes are pushed in whichever order, right and up are on two of them, and the mapping is sound", () => {
  for (const pushes of [[0, 1, 1], [1, 1, 0], [1, 0, 0], [0, 0, 3], [1, 3, 1]]) {
    let mapping = mappingOf({}, padOf());
    pushes.forEach((axis, turn) => {
      mapping = withPush(mapping, turn % 2, still([0, 0, -1, 0]), [0, 0, -1, 0].with(axis, -1));
      assert.equal(mapping.at[turn % 2], axis);
      assert.deepEqual(validMappings({ a: mapping }), { a: mapping });
    });
  }
});

test("a trigger that rests at -1 is no stick, however far it is pulled", () => {
  const mapping = mappingOf({}, padOf());
  assert.equal(withPush(mapping, 0, still([0, 0, -1, 0]), [0, 0, 1, 0]), null);
  assert.equal(withPush(mapping, 0, still([0, 0, -1, 0]), [0.65, 0, 1, 0]).at[0], 0);
});

test("a stick that strays at rest has a dead zone about all of that, and a hardly pushed one is not taken", () => {
  const atRest = Array.from({ length: 15 }, (_, turn) => [0.02 + 0.08 * (turn % 2), 0, 0, 0]);
  const mapping = withPush(mappingOf({}, padOf()), 0, atRest, [1, 0, 0, 0]);
  assert.equal(withPush(mapping, 0, atRest, [0.3, 0, 0, 0]), null);
  for (const axes of atRest) assert.ok(Math.hypot(...stickOf(mapping, axes)) <= mapping.dead);
});

test("a mapping is kept with the person's settings, and counts for a gamepad with as many buttons and axes", () => {
  const settings = new Settings();
  const mapping = withUse(mappingOf({}, padOf()), "enable", 2);
  settings.change({ pads: { a: mapping } });
  const { pads } = new Settings().values;
  assert.deepEqual(mappingOf(pads, padOf()), mapping);
  assert.deepEqual(mappingOf(pads, padOf({ axes: [0, 0] })).uses, still("stop", 4));
  assert.deepEqual(mappingOf(pads, padOf({ id: "b" })).uses, still("stop", 4));
});

test("a malformed mapping is refused, and leaves the others", () => {
  const good = mappingOf({}, padOf());
  const faults = [
    { uses: [] }, { uses: ["enable", ""] }, { uses: ["stop", "fly"] }, { uses: "stop" }, { uses: still("stop", 65) }, { uses: [["stop"], "stop"] },
    { at: [0, 4] }, { at: [1, 1] }, { at: [-1, 0] }, { at: [0.5, 1] }, { at: [0] }, { at: ["0", 1] }, { axes: undefined },
    { way: [0, 1] }, { way: [1] }, { rest: [0.6, 0] }, { rest: [null, 0] }, { rest: [Number.NaN, 0] }, { dead: 0.6 }, { dead: -0.1 }, { dead: "0.1" }, { dead: undefined },
  ];
  for (const fault of faults) assert.deepEqual(validMappings({ bad: { ...good, ...fault }, good }), { good }, JSON.stringify(fault));
  for (const stored of [null, undefined, 7, "stop", [good.uses], { a: null }, { a: 1 }]) assert.deepEqual(validMappings(stored), {});
  assert.equal(Object.keys(validMappings(Object.fromEntries(still(0, 30).map((_, at) => [`pad ${at}`, good])))).length, 10);
});

test("where Stop was on another button than usual before there were mappings, every button stops until one is made", () => {
  for (const [gamepadStop, uses] of [["any", still("stop", 4)], ["2", still("stop", 4)], ["1", ["enable", "stop", "gripper", ""]]]) {
    fakes.localStorage.setItem("latentarm.settings.", JSON.stringify({ gamepadStop }));
    const settings = new Settings();
    assert.deepEqual(mappingOf(settings.values.pads, padOf({ mapping: "standard" })).uses, uses);
    settings.change({ theme: "dark" });
    assert.deepEqual(mappingOf(new Settings().values.pads, padOf({ mapping: "standard" })).uses, uses);
  }
});

test("a gamepad is named without its maker's numbers", () => {
  const names = { "Xbox 360 Controller (STANDARD GAMEPAD Vendor: 045e Product: 028e)": "Xbox 360 Controller", "045e-028e-Microsoft X-Box 360 pad": "Microsoft X-Box 360 pad", "(x)": "(x)" };
  for (const [id, name] of Object.entries(names)) assert.equal(nameOf({ id }), name);
});
