/** The figures of the report, of drives that went well, went wrong, were broken off, or changed their input. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { outcomeWords, stoppedBy } from "#pages/history/drive_words.js";
import { FIGURES, figureOf } from "#pages/history/figures.js";
import { newBrowser } from "./browser.js";

beforeEach(newBrowser);

const NOBODY = { person: 0, page: 0, arm: 0 };
const drive = (rest) => ({ time_s: 10, steps: 2, outcome: null, ended: "next", presses: 1, stops_by: NOBODY, input_s: {}, ...rest });
const DONE = drive({ outcome: "success", time_s: 30, presses: 7, stops_by: { person: 1, page: 2, arm: 0 }, input_s: { keyboard: 5, switch: 9 } });
const FAILED = drive({ outcome: "failure", time_s: 90, stops_by: { person: 0, page: 0, arm: 3 }, input_s: { keyboard: 6 } });
const GIVEN_UP = drive({ time_s: 4, stops_by: { person: 2, page: 0, arm: 0 } });
const BROKEN_OFF = drive({ time_s: 3, ended: "broken_off" });
const ALL = [DONE, FAILED, GIVEN_UP, BROKEN_OFF];
/** Of a task without steps, kept before inputs were timed. */
const OLD = drive({ steps: null, time_s: 1, input_s: null });

test("one drive of four that was done is a quarter, however the others ended", () => {
  assert.equal(figureOf("success", ALL), "25 % (1 of 4)");
  assert.equal(figureOf("success", [DONE, DONE]), "100 % (2 of 2)");
});

test("a drive whose end nobody can know is neither done nor not done", () => {
  assert.equal(figureOf("success", [...ALL, OLD]), "25 % (1 of 4)");
  assert.equal(figureOf("success", [OLD]), "–");
});

test("a drive that was soon over without an end does not make the time to finish shorter", () => {
  assert.equal(figureOf("time", ALL), "30 s");
  assert.equal(figureOf("time", [DONE, { ...DONE, time_s: 50 }, { ...DONE, time_s: 20 }, FAILED]), "30 s");
  assert.equal(figureOf("time", [FAILED, BROKEN_OFF]), "–");
  assert.equal(figureOf("driven", ALL), "2 min 7 s");
  assert.equal(figureOf("drives", ALL), "4");
});

test("stops by people, by the page and by the arm are not mixed, and belong to every drive", () => {
  assert.deepEqual(["stops_person", "stops_page", "stops_arm"].map((figure) => figureOf(figure, ALL)), ["0.8", "0.5", "0.8"]);
  assert.equal(stoppedBy(DONE), "one stop by a person, 2 stops by the page");
  assert.equal(stoppedBy(BROKEN_OFF), "no stops");
  assert.equal(figureOf("presses", ALL), "2.5");
});

test("the input used most is the one that was pushed longest, not each drive's first", () => {
  assert.equal(figureOf("input", ALL), "Keyboard (55 %)");
  assert.equal(figureOf("input", [DONE]), "Switch (64 %)");
});

test("a drive whose inputs were not timed is said to be unknown", () => {
  assert.equal(figureOf("input", [DONE, OLD]), "Switch (64 %); not known for one drive");
  assert.equal(figureOf("input", [OLD, OLD]), "not known for 2 drives");
  assert.equal(figureOf("input", [GIVEN_UP]), "–");
});

test("every figure says of no drives that there are none", () => {
  for (const figure of FIGURES) assert.match(figureOf(figure, []), /^(0|0\.0 s|–)$/, figure);
});

test("the end of a drive is said as it was", () => {
  assert.deepEqual([...ALL, OLD].map(outcomeWords), ["Done", "Went wrong", "Not finished", "Broken off: the program was ended", "Not known"]);
});
