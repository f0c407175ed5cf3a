import assert from "node:assert/strict";
import { test } from "node:test";
import { Practice, STEPS } from "#pages/practice/steps.js";

const START = [0.5, 0, 0.4];
const FOOD = [0.5, 0, 0.02];
const REST = { engaged: false, moving: false, pressed: false, tool: START, goals: [FOOD] };
const READY = { ...REST, engaged: true };

test("each step is done by what the person does, in this order", () => {
  const practice = new Practice();
  assert.equal(practice.step, "enable");
  assert.ok(!practice.see(REST));
  assert.ok(practice.see(READY));
  assert.ok(!practice.see({ ...READY, pressed: true }), "a press that moves nothing is not enough");
  assert.ok(practice.see({ ...READY, moving: true, pressed: true }));
  assert.ok(!practice.see({ ...READY, moving: true, pressed: true }));
  assert.ok(practice.see({ ...READY, moving: true, pressed: true, tool: [0.5, 0, 0.36] }), "3 cm are seen");
  assert.ok(!practice.see({ ...READY, moving: true, pressed: true }));
  assert.ok(practice.see(READY));
  assert.equal(practice.step, "stop");
  assert.ok(!practice.see(REST), "an arm that stops by itself was not stopped by the person");
  assert.ok(practice.stopped());
  assert.ok(!practice.see(READY));
  assert.ok(practice.see({ ...READY, tool: [0.5, 0.05, 0.08] }));
  assert.equal(practice.step, null);
  assert.equal(practice.done, STEPS.length);
});

test("Stop before it is asked for ticks nothing off", () => {
  const practice = new Practice();
  assert.ok(!practice.stopped());
  assert.equal(practice.done, 0);
});

test("where there is nothing to reach, some way is enough", () => {
  const practice = new Practice();
  practice.done = STEPS.indexOf("reach");
  const seen = { ...READY, goals: [] };
  assert.ok(!practice.see(seen));
  assert.ok(!practice.see({ ...seen, tool: [0.6, 0, 0.4] }));
  assert.ok(practice.see({ ...seen, tool: [0.66, 0, 0.4] }));
});
