import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Deflection } from "#pages/inputs/deflection.js";
import { attachKeyboard, unfocus } from "#pages/inputs/keyboard.js";
import { Settings } from "#pages/settings/settings.js";
import { FakeElement, key, newBrowser } from "./browser.js";

let input;
let settings;
let done;

beforeEach(() => {
  newBrowser();
  input = Object.assign(new Deflection(), { flowing: true });
  settings = new Settings();
  done = [];
  attachKeyboard(input, settings, {
    enable: () => done.push("enable"),
    nextMode: () => done.push("mode"),
    axes: (index) => done.push(index),
    gripper: () => done.push("gripper"),
  });
});

test("a pointer leaves no focus on a button that it presses, and a key does", () => {
  const blurred = [];
  const button = Object.assign(new FakeElement("button"), { blur: () => blurred.push("button") });
  document.activeElement = button;
  unfocus({ detail: 0, target: button });
  assert.deepEqual(blurred, []);
  unfocus({ detail: 1, target: button });
  assert.deepEqual(blurred, ["button"]);
  document.activeElement = new FakeElement("input");
  unfocus({ detail: 1, target: button });
  assert.deepEqual(blurred, ["button"]);
});

const at = () => [input.x, input.y];

test("an arrow moves while it is held", () => {
  key("keydown", "ArrowUp");
  assert.deepEqual(at(), [0, 1]);
  key("keydown", "ArrowUp", { repeat: true });
  key("keyup", "ArrowUp");
  assert.deepEqual(at(), [0, 0]);
  assert.equal(input.source, null);
});

test("two arrows move slantwise, opposite ones cancel, and letting go of one leaves the other", () => {
  key("keydown", "ArrowUp");
  key("keydown", "ArrowRight");
  assert.deepEqual(at(), [1, 1]);
  key("keydown", "ArrowLeft");
  assert.deepEqual(at(), [0, 1]);
  key("keyup", "ArrowUp");
  key("keyup", "ArrowRight");
  assert.deepEqual(at(), [-1, 0]);
});

test("an arrow and its letter together are no faster", () => {
  key("keydown", "ArrowUp");
  key("keydown", "KeyW");
  assert.deepEqual(at(), [0, 1]);
});

test("letters and digits do nothing once they are turned off; arrows and Enter still do", () => {
  settings.change({ shortcuts: false });
  for (const code of ["KeyW", "KeyM", "KeyG", "Digit2"]) key("keydown", code);
  assert.deepEqual(at(), [0, 0]);
  key("keydown", "Enter");
  key("keydown", "ArrowDown");
  assert.deepEqual(at(), [0, -1]);
  assert.deepEqual(done, ["enable"]);
});

test("Enter enables, M changes the mode, digits choose axes, G moves the gripper", () => {
  for (const code of ["Enter", "KeyM", "Digit3", "KeyG"]) key("keydown", code);
  assert.deepEqual(done, ["enable", "mode", 2, "gripper"]);
});

test("a key that repeats because it is held acts once", () => {
  key("keydown", "KeyM");
  key("keydown", "KeyM", { repeat: true });
  key("keydown", "KeyG");
  key("keydown", "KeyG", { repeat: true });
  assert.deepEqual(done, ["mode", "gripper"]);
});

for (const modifier of ["ctrlKey", "altKey", "metaKey"]) {
  test(`with ${modifier} a key is the browser's, and what was held is let go`, () => {
    key("keydown", "ArrowUp");
    key("keydown", "ArrowUp", { [modifier]: true });
    assert.deepEqual(at(), [0, 0]);
    key("keydown", "KeyM", { [modifier]: true });
    assert.deepEqual(done, []);
  });
}

test("keys in a text field, a list or a dialog are theirs", () => {
  for (const kind of ["textarea", "select", "dialog"]) {
    const target = new FakeElement(kind);
    key("keydown", "KeyW", { target });
    key("keydown", "KeyM", { target });
  }
  assert.deepEqual(at(), [0, 0]);
  assert.deepEqual(done, []);
});

test("Enter on a button presses the button and does not enable", () => {
  key("keydown", "Enter", { target: new FakeElement("button") });
  assert.deepEqual(done, []);
});

test("arrows choose among radio buttons until the arm is enabled, and then drive", () => {
  const target = new FakeElement("input[type=radio]");
  target.matches = (selector) => selector === "input[type=radio]";
  target.closest = () => null;
  input.flowing = false;
  key("keydown", "ArrowUp", { target });
  assert.deepEqual(at(), [0, 0]);
  input.flowing = true;
  assert.ok(key("keydown", "ArrowUp", { target }).defaultPrevented);
  assert.deepEqual(at(), [0, 1]);
});

test("after everything was dropped, a key that is still held moves nothing until it is pressed anew", () => {
  key("keydown", "ArrowUp");
  input.neutral();
  key("keydown", "ArrowUp", { repeat: true });
  assert.deepEqual(at(), [0, 0]);
  key("keydown", "ArrowRight");
  assert.deepEqual(at(), [1, 0]);
  key("keyup", "ArrowRight");
  key("keyup", "ArrowUp");
  key("keydown", "ArrowUp");
  assert.deepEqual(at(), [0, 1]);
});
