/** What the Personalise and Teach pages say and show. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { between } from "#pages/personalise/replay.js";
import { missedWords, stepOf } from "#pages/personalise/steps.js";
import { freeName, isBusy, progressShare, progressWords } from "#pages/teach/training.js";
import { newBrowser } from "./browser.js";

beforeEach(newBrowser);

test("the page follows what the server does, and begins where nobody was asked or asking failed", () => {
  assert.equal(stepOf(null, false), "begin");
  const steps = ["preparing", "asking", "thinking", "learning", "learned", "refused", "kept", "failed"].map((phase) => stepOf({ phase }, false));
  assert.deepEqual(steps, ["working", "asking", "working", "working", "learned", "refused", "kept", "begin"]);
});

test("a person can be asked again once something was learned, not before", () => {
  for (const phase of ["learned", "kept"]) assert.equal(stepOf({ phase }, true), "begin");
  for (const phase of ["asking", "learning"]) assert.notEqual(stepOf({ phase }, true), "begin");
});

test("small errors are said with a decimal", () => {
  assert.deepEqual([0.0312, 0.25, 1.2, null].map(missedWords), ["3.1 %", "25 %", "120 %", "–"]);
});

test("a motion is shown between its frames, turning the short way", () => {
  const half = Math.SQRT1_2;
  const frames = [[[0, 0, 0, 1, 0, 0, 0]], [[1, 0, 2, -half, 0, 0, -half]]];
  const [[x, y, z, w, i, j, k]] = between(frames, 0.5);
  assert.deepEqual([x, y, z, i, j], [0.5, 0, 1, 0, 0]);
  assert.ok(Math.abs(2 * Math.acos(w) - Math.PI / 4) < 1e-9);
  assert.ok(k > 0);
  assert.deepEqual(between(frames, 0)[0].slice(0, 3), [0, 0, 0]);
  assert.deepEqual(between(frames, 1)[0].slice(0, 3), [1, 0, 2]);
});

const TRAINING = { phase: "training", run: "a", epoch: 3, epochs: 12, loss: 0.12345, seconds_left: 4.2, why: [] };

test("a training says how far it is", () => {
  assert.equal(progressWords(TRAINING), "Pass 3 of at most 12 · loss 0.123");
  assert.equal(progressShare(TRAINING), 25);
  assert.ok(isBusy(TRAINING));
});

test("a training that is done says whether it ended early", () => {
  const done = { ...TRAINING, phase: "done", seconds_left: null };
  assert.equal(progressWords(done), "3 passes, until it stopped improving · loss 0.123");
  assert.equal(progressWords({ ...done, epoch: 12 }), "12 passes · loss 0.123");
  assert.equal(progressShare(done), 100);
  assert.ok(!isBusy(done));
});

test("a model without passes says none", () => {
  assert.equal(progressWords({ ...TRAINING, phase: "done", epoch: 0, epochs: 0, loss: null, seconds_left: null }), "");
});

test("a new run gets a name that is free, and the next one once it is trained", () => {
  assert.equal(freeName("", { runs: [], training: null }), "taught-1");
  assert.equal(freeName("", { runs: ["taught-1", "taught-2"], training: null }), "taught-3");
  assert.equal(freeName("soup", { runs: ["soup"], training: null }), "soup");
  assert.equal(freeName("soup", { runs: ["soup"], training: { phase: "done", run: "soup" } }), "soup-1");
  assert.equal(freeName("stew", { runs: ["soup"], training: { phase: "done", run: "soup" } }), "stew");
  assert.equal(freeName("soup-1", { runs: ["soup-1"], training: { phase: "done", run: "soup-1" } }), "soup-2");
});
