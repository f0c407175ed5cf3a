import assert from "node:assert/strict";
import { test } from "node:test";

import { momentAt, standing } from "#pages/history/player.js";
import { byDay, byWeek, counted, dayOf, inDays, mondayOf, MOST_DAYS, MOST_WEEKS } from "#pages/history/weeks.js";

const drive = (started) => ({ started });

test("a week begins on Monday, also over the end of a year", () => {
  assert.equal(mondayOf("2026-11-23T12:00:00+00:00"), "2026-11-23");
  assert.equal(mondayOf("2026-11-29T12:00:00+00:00"), "2026-11-23");
  assert.equal(mondayOf("2027-01-01T12:00:00+00:00"), "2026-12-28");
});

test("weeks without drives are there and say nothing", () => {
  const weeks = byWeek([drive("2026-11-23T12:00:00+00:00"), drive("2026-11-03T12:00:00+00:00")]);
  assert.deepEqual(weeks.map(({ first }) => first), ["2026-11-02", "2026-11-09", "2026-11-16", "2026-11-23"]);
  assert.deepEqual(weeks.map(({ drives }) => drives.length), [1, 0, 0, 1]);
  assert.deepEqual(byWeek([]), []);
});

test("drives of few days are compared day by day, and a day begins at midnight where the page is read", () => {
  const days = ["2026-02-27T12:00:00+00:00", "2026-03-01T12:00:00+00:00", "2026-03-01T11:00:00+00:00"].map((at) => drive(at));
  assert.equal(inDays(days), true);
  assert.deepEqual(byDay(days).map(({ first, drives }) => [first, drives.length]), [["2026-02-27", 1], ["2026-02-28", 0], ["2026-03-01", 2]]);
  const later = new Date(Date.parse(days[0].started) + MOST_DAYS * 24 * 3600 * 1000).toISOString();
  assert.equal(inDays([...days, drive(later)]), false);
  const evening = new Date(2026, 2, 1, 23, 30);
  assert.equal(dayOf(evening.toISOString()), "2026-03-01");
});

test("only the last weeks are compared", () => {
  const weeks = byWeek([drive("2025-01-01T12:00:00+00:00"), drive("2026-11-23T12:00:00+00:00")]);
  assert.equal(weeks.length, MOST_WEEKS);
  assert.equal(weeks[MOST_WEEKS - 1].first, "2026-11-23");
});

test("what there is most of comes first", () => {
  assert.deepEqual(counted(["a", "b", "b"]), [["b", 2], ["a", 1]]);
});

const pose = (x) => [x, 0, 0, 1, 0, 0, 0];
const TRACE = {
  period_s: 0.1,
  t: [0, 0.1, 5, 5.1],
  tool: [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]],
  bodies: [[pose(0)], [pose(1)], [pose(2)], [pose(3)]],
  width_m: [null, null, null, null],
  things: [{ t: 0, poses: [pose(0)], grains: [[1, 1, 1]] }, { t: 5, poses: [pose(5)], grains: null }],
  marks: [{ t: 0, code: "enabled" }, { t: 4, code: "stop_pressed" }, { t: 4.5, code: "enabled" }],
};

test("a replay glides between moments, and stands where nothing changed", () => {
  const things = standing(TRACE);
  assert.equal(momentAt(TRACE, things, 0.05).bodies[0][0], 0.5);
  assert.equal(momentAt(TRACE, things, 3).tool[0], 1);
  assert.equal(momentAt(TRACE, things, 5).tool[0], 2);
  assert.equal(momentAt(TRACE, things, 99).tool[0], 3);
});

test("a replay shows things as they stood, with the grains of before, and when the arm was stopped", () => {
  const things = standing(TRACE);
  assert.deepEqual(momentAt(TRACE, things, 5).things, { poses: [pose(5)], grains: [[1, 1, 1]] });
  assert.deepEqual([3.9, 4.2, 4.6].map((t) => momentAt(TRACE, things, t).stopped), [false, true, false]);
});
