import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Deflection } from "#pages/inputs/deflection.js";
import { attachGamepad } from "#pages/inputs/gamepad.js";
import { say } from "#pages/layout/words.js";
import { mappingOf } from "#pages/settings/pads.js";
import { Settings } from "#pages/settings/settings.js";
import { elementsOf, event, newBrowser, pass } from "./browser.js";

let fakes;
let input;
let settings;
let pads;
let done;
let scanning;
let told;

function appear(index = 0, id = "a") {
  const pad = { index, id, mapping: "standard", connected: true, axes: [0, 0], buttons: Array.from({ length: 6 }, () => ({ pressed: false })) };
  pads[index] = pad;
  return pad;
}

/** A gamepad that has been seen at rest. */
function plug(index = 0) {
  const pad = appear(index);
  poll();
  return pad;
}

function press(pad, number) {
  pad.buttons[number].pressed = true;
  poll();
  pad.buttons[number].pressed = false;
  poll();
}

const poll = () => input.dispatchEvent(new Event("poll"));

beforeEach(() => {
  fakes = newBrowser();
  pads = [null, null];
  Object.defineProperty(globalThis.navigator, "getGamepads", { value: () => pads, configurable: true });
  done = [];
  scanning = false;
  input = Object.assign(new Deflection(), { flowing: true, halt: (why) => done.push(why) });
  settings = new Settings();
  ({ told } = elementsOf({ told: "unrested" }));
  const press = (number, down) => {
    if (scanning && down) done.push(`switch ${number}`);
    return scanning;
  };
  attachGamepad(input, settings, { press }, {
    enable: () => done.push("enable"),
    stop: () => done.push("stop"),
    gripper: () => done.push("gripper"),
    nextMode: () => done.push("mode"),
  });
});

test("the stick moves the arm; up is up", () => {
  plug().axes = [0.5, -0.75];
  poll();
  assert.deepEqual([input.x, input.y, input.source], [0.5, 0.75, "gamepad"]);
});

test("the input has the gamepad's id, in the letters and the length that the server takes", () => {
  const pad = appear(0, `Pad\u2122; [${"9".repeat(99)}]`);
  poll();
  pad.axes = [1, 0];
  poll();
  assert.equal(input.name, `Pad    ${"9".repeat(73)}`);
});

test("a stick that rests a little off its middle is at rest", () => {
  const pad = plug();
  pad.axes = [0.05, -0.05];
  poll();
  assert.equal(input.source, null);
  pad.axes = [0.5, 0];
  poll();
  pad.axes = [0.05, -0.05];
  poll();
  assert.deepEqual([input.x, input.y, input.source], [0, 0, null]);
});

test("a resting gamepad does not let go of what another way presses", () => {
  plug();
  input.hold("keyboard", 0, 1);
  poll();
  assert.equal(input.source, "keyboard");
});

test("an axis that reports nonsense is at rest", () => {
  plug().axes = [Number.NaN, 0];
  poll();
  assert.equal(input.source, null);
});

test("the button of the person's choice stops, the first enables, on press and not on release", () => {
  press(plug(), 1);
  press(pads[0], 0);
  assert.deepEqual(done, ["stop", "enable"]);
});

test("the third button moves the gripper, and the shoulders go on to the next directions", () => {
  const pad = plug();
  for (const number of [2, 3, 4, 5]) press(pad, number);
  assert.deepEqual(done, ["gripper", "mode", "mode"]);
});

test("a button does what the person has chosen for it, on the gamepad that they chose it for", () => {
  const [mine, other] = [plug(0), appear(1, "b")];
  poll();
  settings.change({ pads: { a: { ...mappingOf({}, mine), uses: ["stop", "", "", "enable", "gripper", "nextMode"] } } });
  for (const number of [0, 1, 2, 3, 4, 5]) press(mine, number);
  press(other, 0);
  assert.deepEqual(done, ["stop", "enable", "gripper", "mode", "enable"]);
});

test("every button of a gamepad without the standard layout stops, and the page says so until it is mapped", () => {
  const pad = plug();
  pad.mapping = "";
  for (const number of [0, 3, 5]) press(pad, number);
  assert.deepEqual(done, ["stop", "stop", "stop"]);
  assert.equal(told.textContent, say("gamepad.unknown", { name: "a" }));
  settings.change({ pads: { a: mappingOf({}, { ...pad, mapping: "standard" }) } });
  press(pad, 0);
  assert.equal(done.pop(), "enable");
  assert.equal(told.textContent, "");
});

test("behind a dialog a button stops, and does nothing else", () => {
  fakes.document.querySelector = (wanted) => (wanted.includes("dialog[open]") ? { localName: "dialog" } : null);
  const pad = plug();
  for (const number of [0, 1, 2, 4]) press(pad, number);
  assert.deepEqual(done, ["stop"]);
});

test("a press that answers the settings is no switch, but Stop stops", () => {
  scanning = true;
  fakes.document.querySelector = () => ({ localName: "dialog" });
  const pad = plug();
  for (const number of [0, 1]) press(pad, number);
  assert.deepEqual(done, ["stop"]);
});

test("a stick that is at rest by one mapping and pushed by another moves nothing until it was let go", () => {
  const pad = plug();
  pad.axes = [0, 0, 1, 0];
  poll();
  assert.equal(input.source, null);
  settings.change({ pads: { a: { ...mappingOf({}, pad), at: [2, 3] } } });
  poll();
  assert.equal(input.source, null);
  assert.equal(told.textContent, say("gamepad.unrested", { name: "a" }));
  pad.axes = [0, 0, 0, 0];
  poll();
  pad.axes = [0, 0, 1, 0];
  poll();
  assert.equal(input.source, "gamepad");
});

test("where scanning is on, buttons are switches and neither stop nor enable", () => {
  scanning = true;
  press(plug(), 1);
  press(pads[0], 0);
  assert.deepEqual(done, ["switch 1", "switch 0"]);
});

test("a gamepad that is taken away stops the arm, however it is noticed", () => {
  const pad = plug();
  poll();
  pad.connected = false;
  poll();
  plug();
  poll();
  fakes.window.dispatchEvent(event("gamepaddisconnected", { gamepad: { index: 0 } }));
  assert.deepEqual(done, ["gamepad_lost", "gamepad_lost"]);
});

test("another gamepad that is taken away stops nothing", () => {
  plug(0);
  poll();
  fakes.window.dispatchEvent(event("gamepaddisconnected", { gamepad: { index: 1 } }));
  assert.deepEqual(done, []);
});

test("the gamepad that is pushed drives, and an idle first one shadows nothing", () => {
  plug(0);
  plug(1).axes = [1, 0];
  poll();
  assert.deepEqual([input.x, input.source, input.device], [1, "gamepad", 1]);
});

test("a second gamepad does not take over from the first, nor when that is let go", () => {
  const [first, second] = [plug(0), plug(1)];
  first.axes = [0, 1];
  poll();
  second.axes = [1, 0];
  poll();
  assert.deepEqual([input.x, input.device], [0, 0]);
  first.axes = [0, 0];
  poll();
  assert.equal(input.source, null);
  second.axes = [0, 0];
  poll();
  second.axes = [1, 0];
  poll();
  assert.equal(input.device, 1);
});

test("a button that stops does so on every gamepad", () => {
  plug(0);
  press(plug(1), 1);
  press(pads[0], 1);
  assert.deepEqual(done, ["stop", "stop"]);
});

for (const [what, axes] of [["pushed", [0.7, 0]], ["with an axis that rests at -1", [0, -1]]]) {
  test(`a gamepad that appears ${what} moves nothing, is named, and leaves the keyboard alone, until it was let go`, () => {
    const pad = appear();
    pad.axes = axes;
    poll();
    poll();
    assert.equal(input.source, null);
    assert.equal(told.textContent, say("gamepad.unrested", { name: "a" }));
    input.hold("keyboard", 0, 1);
    assert.equal(input.source, "keyboard");
    input.release("keyboard");
    pad.axes = [0, 0];
    poll();
    assert.equal(told.textContent, "");
    pad.axes = [0.7, 0];
    poll();
    assert.equal(input.source, "gamepad");
  });
}

test("a gamepad that is pushed when inputs begin to flow, or when all let go, moves nothing until it was let go", () => {
  const pad = plug();
  input.flowing = false;
  pad.axes = [0.7, 0];
  pass(100);
  assert.equal(input.source, "gamepad");
  for (const begins of [() => (input.flowing = true), () => input.neutral()]) {
    begins();
    poll();
    assert.equal(input.source, null);
    assert.equal(told.textContent, say("gamepad.unrested", { name: "a" }));
    pad.axes = [0, 0];
    poll();
    pad.axes = [0.7, 0];
    poll();
    assert.equal(input.source, "gamepad");
  }
});

test("an axis that reports nonsense ends a push, and does not count as let go", () => {
  const pad = plug();
  for (const axis of [0.7, Number.NaN, 0.7]) {
    pad.axes = [axis, 0];
    poll();
  }
  assert.equal(input.source, null);
});

test("an axis beyond its range counts as full", () => {
  plug().axes = [1.3, -Infinity];
  poll();
  assert.deepEqual([input.x, input.y], [1, 1]);
});

test("of the buttons of a gamepad that appears only Stop counts", () => {
  const pad = appear();
  for (const button of pad.buttons) button.pressed = true;
  poll();
  assert.deepEqual(done, ["stop"]);
});

test("where more is ignored, a stick that rests off its middle drives", () => {
  settings.change({ deadZone: 0.3 });
  const pad = appear();
  pad.axes = [0.25, 0];
  poll();
  poll();
  pad.axes = [0.7, 0];
  poll();
  assert.equal(input.source, "gamepad");
});

test("buttons are noticed within 0.1 s before the arm is enabled, but not on a hidden page", () => {
  input.flowing = false;
  const pad = plug();
  pad.buttons[0].pressed = true;
  pass(100);
  assert.deepEqual(done, ["enable"]);
  fakes.document.hidden = true;
  pad.buttons[1].pressed = true;
  pass(200);
  assert.deepEqual(done, ["enable"]);
});

/** Time passes with the gamepad as it is; it reports every 10 ms, if at all. */
function live(pad, ms, reports = true) {
  for (let passed = 0; passed < ms; passed += 20) {
    pass(20);
    if (reports) pad.timestamp = performance.now();
    poll();
  }
}

for (const axes of [[0.7, 0], [0, 0]]) {
  test(`a gamepad that reports all the time and stands still is gone within 0.12 s, and stops the arm (${axes})`, () => {
    const pad = plug();
    pad.timestamp = 1;
    live(pad, 1000);
    pad.axes = axes;
    live(pad, 1000);
    assert.deepEqual(done, []);
    live(pad, 120, false);
    assert.deepEqual(done, ["gamepad_lost"]);
    live(pad, 5000, false);
    assert.deepEqual(done, ["gamepad_lost"]);
    // It is back, still pushed or not: it drives once it has been at rest.
    input.neutral();
    pad.axes = [0.7, 0];
    live(pad, 200);
    assert.equal(input.source, null);
    pad.axes = [0, 0];
    live(pad, 40);
    pad.axes = [0.7, 0];
    live(pad, 40);
    assert.equal(input.source, "gamepad");
  });
}

test("a stick that is held goes on where the browser's time moves with changes alone, or not at all", () => {
  const [changes, none] = [plug(0), plug(1)];
  for (let turn = 0; turn < 100; turn += 1) {
    changes.axes = [0.5 + 0.001 * (turn % 2), 0];
    changes.timestamp = performance.now();
    live(changes, turn % 10 ? 20 : 400, false);
    none.axes = [0.5 + 0.001 * (turn % 3), 0];
  }
  live(changes, 9000, false);
  assert.deepEqual(done, []);
  assert.equal(input.source, "gamepad");
});

test("a page that hangs for a second takes no gamepad for gone", () => {
  const pad = plug();
  pad.timestamp = 1;
  live(pad, 1000);
  pass(1000);
  poll();
  live(pad, 100);
  assert.deepEqual(done, []);
});
