import assert from "node:assert/strict";
import { test } from "node:test";

import { Deflection } from "#pages/inputs/deflection.js";

test("one way of pressing at a time: the others wait until it is let go", () => {
  const input = new Deflection();
  input.hold("dpad", 1, 0);
  input.hold("keyboard", 0, 1);
  assert.deepEqual([input.x, input.y, input.source], [1, 0, "dpad"]);
  input.release("keyboard");
  assert.equal(input.source, "dpad");
  input.release("dpad");
  input.hold("keyboard", 0, 1);
  assert.deepEqual([input.x, input.y, input.source], [0, 1, "keyboard"]);
});

test("a latched press stays until it is let go", () => {
  const input = new Deflection();
  input.hold("switch", 0, -1, true);
  assert.ok(input.latched);
  input.release("switch");
  assert.ok(!input.latched);
  assert.equal(input.source, null);
});

test("beginning and ending are told at once, changes between them are not", () => {
  const input = new Deflection();
  const told = [];
  input.addEventListener("turned", (event) => told.push([event.detail, input.x]));
  for (const x of [0.2, 0.7, 0]) input.hold("pointer", x, 0);
  assert.deepEqual(told, [["pointer", 0.2], ["pointer", 0]]);
});

test("letting go of everything tells every way of pressing", () => {
  const input = new Deflection();
  let dropped = 0;
  input.addEventListener("dropped", () => (dropped += 1));
  input.hold("gamepad", 1, 1, true);
  input.neutral();
  assert.equal(dropped, 1);
  assert.deepEqual([input.x, input.y, input.latched, input.source], [0, 0, false, null]);
});

test("a slanted push presses two directions, a nearly straight one presses one", () => {
  const input = new Deflection();
  assert.deepEqual(input.pressed, []);
  input.hold("pointer", 0.5, 0.5);
  assert.deepEqual(input.pressed, ["up", "right"]);
  input.hold("pointer", -0.9, -0.1);
  assert.deepEqual(input.pressed, ["left"]);
});

test("a device that was pushed while another one drove counts only once it was let go", () => {
  const input = new Deflection();
  input.hold("gamepad", 1, 0, false, 1);
  input.hold("keyboard", 0, 1);
  input.hold("gamepad", 0, 1, false, 2);
  assert.equal(input.device, 1);
  input.release("gamepad", 1);
  input.hold("keyboard", 1, 1);
  input.hold("gamepad", 0, 1, false, 2);
  assert.equal(input.source, null);
  input.release("keyboard");
  input.hold("keyboard", 1, 0);
  assert.equal(input.source, "keyboard");
});

test("a device of which nobody knows since when it is so lets go, and counts once it was at rest", () => {
  const input = new Deflection();
  input.hold("gamepad", 1, 0);
  input.distrust("gamepad", 0);
  assert.deepEqual([input.x, input.source], [0, null]);
  input.hold("gamepad", 1, 0);
  assert.equal(input.source, null);
  input.release("gamepad");
  input.hold("gamepad", 1, 0);
  assert.equal(input.source, "gamepad");
});
