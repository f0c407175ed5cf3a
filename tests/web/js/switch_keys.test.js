/** Keys that are switches reach the scan and nothing else. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Deflection } from "#pages/inputs/deflection.js";
import { attachKeyboard } from "#pages/inputs/keyboard.js";
import { groupOf } from "#pages/inputs/scanning.js";
import { Scanner } from "#pages/inputs/scanner.js";
import { attachSwitchKeys } from "#pages/inputs/switch_keys.js";
import { Settings } from "#pages/settings/settings.js";
import { event, FakeElement, key, newBrowser, pass } from "./browser.js";

class FakeField extends FakeElement {
  constructor() {
    super("input");
    Object.assign(this, { readOnly: false, selectionStart: 0 });
  }
}

let settings;
let input;
let scanner;
let did;

const choices = (...ids) => ids.map((id) => ({ id, label: id, act: () => did.push(id) }));
const lit = () => scanner.choices[scanner.lit].id;

function press(code, target) {
  const pressed = key("keydown", code, { target });
  key("keyup", code, { target });
  return pressed;
}

beforeEach(() => {
  globalThis.window = newBrowser().window;
  globalThis.HTMLInputElement = FakeField;
  settings = new Settings();
  settings.change({ panel: "switch", dwellS: 20, acceptS: 0, releaseS: 0 });
  input = Object.assign(new Deflection(), { flowing: false, live: false, halt: () => input.neutral() });
  scanner = new Scanner(input, settings);
  did = [];
  attachSwitchKeys(scanner, input, settings);
  const other = (what) => () => did.push(what);
  attachKeyboard(input, settings, { enable: other("enabled"), nextMode: other("mode"), axes: other("axes"), gripper: other("gripper") });
  scanner.offer(choices("first", "second", "stop"));
  pass(300);
});

for (const kind of ["button", "summary", "select", "a", "input[type=range]", "dialog", "none"]) {
  test(`the switch takes what is lit where the focus is on: ${kind}`, () => {
    assert.ok(press("Enter", new FakeElement(kind)).defaultPrevented);
    assert.deepEqual(did, ["first"]);
  });
}

test("Space comes up without a meaning of its own too, and a key that repeats because it is held is one press", () => {
  settings.change({ switchKey: "Space" });
  const button = new FakeElement("button");
  key("keydown", "Space", { target: button });
  for (let times = 0; times < 20; times += 1) {
    pass(33);
    assert.ok(key("keydown", "Space", { target: button, repeat: true }).defaultPrevented);
  }
  assert.ok(key("keyup", "Space", { target: button }).defaultPrevented);
  assert.deepEqual(did, ["first"]);
});

test("a field keeps the switch's key while somebody types in it, and for 5 s after", () => {
  const field = new FakeField();
  window.dispatchEvent(event("pointerdown", { target: field }));
  assert.ok(!press("Enter", field).defaultPrevented);
  pass(4000);
  press("KeyA", field);
  pass(4990);
  assert.ok(!press("Enter", field).defaultPrevented);
  pass(20);
  assert.ok(press("Enter", field).defaultPrevented);
  assert.deepEqual(did, ["first"]);
});

test("while the arm is enabled no field keeps the switch's key", () => {
  const field = new FakeField();
  input.live = true;
  press("KeyX", field);
  assert.ok(press("Enter", field).defaultPrevented);
  assert.deepEqual(did, ["first"]);
});

test("a field that asks for a key gets it", () => {
  const field = Object.assign(new FakeField(), { readOnly: true });
  field.dataset.asking = "yes";
  assert.ok(!press("Enter", field).defaultPrevented);
  assert.deepEqual(did, []);
});

test("the second key is a switch only where there are two", () => {
  assert.ok(!press("Backspace").defaultPrevented);
  assert.equal(lit(), "first");
  settings.change({ switches: "2" });
  assert.ok(press("Backspace").defaultPrevented);
  assert.equal(lit(), "second");
});

for (const rows of [false, true]) test(`10,000 presses at random, ${rows ? "by rows" : "in one list"}, whatever is offered and has the focus: one is lit, and only that is done`, () => {
  let seed = 1;
  const draw = (many) => {
    seed = (seed * 48271) % 2147483647;
    return seed % many;
  };
  settings.change({ switches: "2", rows });
  const stops = choices("stop")[0];
  const lists = [
    choices("enable", "stop"), [...choices("a", "b"), groupOf("more", "More", () => choices("c", "d"), [stops]), stops], [stops],
    choices("close", "stop"), choices("up", "down", "left", "right", "gripper", "mode", "e", "f", "g", "h", "stop"),
    [groupOf("long", "Long", () => choices(..."ijklmnopqrst"), [stops]), stops],
  ];
  const kinds = ["button", "summary", "select", "a", "none"].map((kind) => new FakeElement(kind));
  let taken = 0;
  for (let times = 0; times < 10_000; times += 1) {
    if (draw(20) === 0) scanner.offer(lists[draw(lists.length)]);
    if (draw(9) === 0) press(["Tab", "ArrowUp", "KeyQ"][draw(3)], kinds[draw(kinds.length)]);
    if (draw(2) === 0) press("Backspace", kinds[draw(kinds.length)]);
    pass(draw(60));
    const expected = lit();
    did = [];
    press("Enter", kinds[draw(kinds.length)]);
    assert.ok(did.every((what) => what === expected || what === "stop"), `${did} where ${expected} was lit`);
    assert.ok(scanner.choices[scanner.lit]);
    assert.ok(scanner.choices.some(({ id }) => id === "stop"));
    taken += did.length;
  }
  assert.ok(taken > 5000, String(taken));
});
