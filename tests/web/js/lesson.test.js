/** What the Teach page says of a training, in words first. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { lessonFigures, lessonWords, shortOnes } from "#pages/teach/lesson.js";
import { leftWords } from "#pages/teach/training.js";
import { newBrowser } from "./browser.js";

beforeEach(newBrowser);

const words = (lesson) => lessonWords({ recordings: 4, learned_from: 2, short: [], ...lesson }).map(({ text }) => text);

test("a model whose directions work is good enough to drive", () => {
  assert.deepEqual(words({ speeds_m_s: [0.12, 0.1], weak: [] }), ["Both directions work. It is good enough to drive."]);
  assert.deepEqual(words({ speeds_m_s: [0.12], weak: [] }), ["Left and right work. It is good enough to drive."]);
});

test("a direction that does little is named, with what to do", () => {
  assert.match(words({ speeds_m_s: [0.01, 0.1], weak: [0] })[0], /^Left and right do little: .*Record/);
  assert.match(words({ speeds_m_s: [0.1, 0.01], weak: [1] })[0], /^Up and down do little: .*Record/);
  assert.match(words({ speeds_m_s: [0, 0], weak: [0, 1] })[0], /^Pushing hardly moves the arm\./);
});

test("recordings that are short are named", () => {
  assert.equal(words({ speeds_m_s: [0.1, 0.1], weak: [], short: [3] })[1], "Recording 3 is short. A longer one would teach more.");
  assert.match(words({ speeds_m_s: [0.1, 0.1], weak: [], short: [3, 5] })[1], /^Recordings 3, 5 are short\./);
  const recordings = [4, 5, 1.5, 4.4].map((seconds, index) => ({ number: index + 1, task: "", seconds }));
  assert.deepEqual(shortOnes(recordings), [3]);
  assert.deepEqual(shortOnes([]), []);
});

test("figures are apart from the words", () => {
  assert.deepEqual(lessonFigures({ recordings: 5, learned_from: 3, short: [], speeds_m_s: [0.123, 0.05], weak: [] }), ["learned from 3 of 5 recordings, and checked on the others", "left and right: 12.3 cm/s", "up and down: 5.0 cm/s"]);
  assert.deepEqual(lessonFigures(null), []);
  assert.equal(leftWords({ phase: "training", seconds_left: 4.2 }), "up to about 5 s left");
  assert.equal(leftWords({ phase: "training", seconds_left: null }), "");
});
