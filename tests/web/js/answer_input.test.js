import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { AnswerInput } from "#pages/personalise/answer_input.js";
import { newBrowser, pass } from "./browser.js";

let fakes;
let input;

/** Hold the gamepad's stick for so long. */
function holdStick(x, y, ms) {
  for (let passed = 0; passed < ms; passed += 20) {
    input.hold("gamepad", x, y);
    pass(20);
  }
}

beforeEach(() => {
  fakes = newBrowser();
  input = new AnswerInput();
});

test("nothing is an answer before there is a question", () => {
  holdStick(1, 0, 500);
  input.release("gamepad");
  assert.equal(input.answer, null);
});

test("a steady push stays as the answer after it is let go", () => {
  input.begin();
  holdStick(0.6, 0.2, 400);
  holdStick(0, 0, 40);
  assert.deepEqual(input.answer, [0.6, 0.2]);
});

test("a stick that springs back passes many places, which are no answers", () => {
  input.begin();
  holdStick(0.8, 0, 400);
  for (const x of [0.6, 0.4, 0.2, 0]) holdStick(x, 0, 20);
  assert.deepEqual(input.answer, [0.8, 0]);
});

test("a push too short to be steady counts as far as it went", () => {
  input.begin();
  for (const x of [0.3, 0.9, 0.5, 0]) holdStick(x, 0, 20);
  assert.deepEqual(input.answer, [0.9, 0]);
});

test("a pointer answers where it is let go", () => {
  input.begin();
  for (const x of [0.9, 0.5, 0.4]) input.hold("pointer", x, 0);
  input.release("pointer");
  assert.deepEqual(input.answer, [0.4, 0]);
});

test("another push changes the answer, and another question forgets it", () => {
  input.begin();
  holdStick(0.6, 0, 400);
  holdStick(0, 0, 40);
  holdStick(0, -0.7, 400);
  holdStick(0, 0, 40);
  assert.deepEqual(input.answer, [0, -0.7]);
  input.begin();
  assert.equal(input.answer, null);
  assert.equal(input.source, null);
});

test("losing the focus lets go, and the answer stays", () => {
  input.begin();
  holdStick(0.6, 0, 400);
  fakes.window.dispatchEvent(new Event("blur"));
  assert.equal(input.source, null);
  assert.deepEqual(input.answer, [0.6, 0]);
});
