/** What is left of the way is told in the person's own directions, and driving them comes to an end there. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { DIRECTIONS } from "#pages/inputs/deflection.js";
import { modeInput } from "#pages/inputs/shaping.js";
import { awayWords } from "#pages/drive/task_words.js";
import { learnedOn, leftToGo, straightOn } from "#pages/drive/to_go.js";
import { DEFAULTS } from "#pages/settings/settings.js";
import { newBrowser, stateOf, welcomeOf } from "./browser.js";

const PAIRS = ["x-y", "z-yaw", "roll-pitch"];
const PARTS = { "x-y": [["shift_m", 0], ["shift_m", 1]], "z-yaw": [["shift_m", 2], ["turn_rad", 2]], "roll-pitch": [["turn_rad", 0], ["turn_rad", 1]] };
const TO_GO = { shift_m: [0.12, -0.034, 0.05], turn_rad: [0.5, -0.2, 1.0], gripper: null };

beforeEach(() => newBrowser());

for (const settings of [{}, { seat: "behind" }, { swapAxes: true, invertX: true }, { invertY: true, seat: "behind" }]) {
  test(`each direction that is told leads there: ${JSON.stringify(settings)}`, () => {
    PAIRS.forEach((pair, axes) => {
      const shaped = (x, y) => modeInput({ ...DEFAULTS, ...settings }, stateOf({ mode: "end_effector", axes }), welcomeOf(), x, y);
      const told = leftToGo(TO_GO, pair, shaped);
      assert.equal(told.length, 2);
      for (const { direction } of told) {
        const sent = shaped(...DIRECTIONS[direction]);
        const along = PARTS[pair].reduce((sum, [of, axis], number) => sum + sent[number] * TO_GO[of][axis], 0);
        assert.ok(along > 0, `${pair} ${direction}`);
      }
    });
  });
}

test("lengths are in centimetres, turns in degrees, and what is small enough is left out", () => {
  const shaped = (x, y) => modeInput(DEFAULTS, stateOf({ mode: "end_effector", axes: 1 }), welcomeOf(), x, y);
  assert.deepEqual(leftToGo(TO_GO, "z-yaw", shaped).map(({ text }) => text), ["Up 5.0 cm", "Left 57°"]);
  assert.deepEqual(leftToGo({ ...TO_GO, shift_m: [0, 0, -0.002], turn_rad: [0, 0, -0.04] }, "z-yaw", shaped), []);
});

test("the step tells the turn apart from the distance", () => {
  const at = (to_go) => awayWords(stateOf({ task: { outcome: null, to_go } }));
  assert.equal(at({ shift_m: [0.03, 0.04, 0], turn_rad: [0, 0.9, 0], gripper: null }), "5 cm, turn 52°");
  assert.equal(at({ shift_m: [0.03, 0.04, 0], turn_rad: [0, 0.1, 0], gripper: null }), "5 cm to go");
  assert.equal(at({ ...TO_GO, gripper: "close" }), "");
});

test("along straight lines the sentence has a direction and number of the list of the pair, and then another pair", () => {
  for (let number = 0; number < 200; number += 1) {
    const [a, b, c, d, e, f] = Array.from({ length: 6 }, (_, at) => Math.sin(7919 * (6 * number + at)) ** 3);
    const toGo = { shift_m: [a / 2, b / 2, c / 2], turn_rad: [d, e, f], gripper: null };
    const ways = PAIRS.map((pair, axes) => leftToGo(toGo, pair, (x, y) => modeInput(DEFAULTS, stateOf({ mode: "end_effector", axes }), welcomeOf(), x, y)));
    PAIRS.forEach((pair, axes) => {
      const said = straightOn(ways, axes, PAIRS, number % 2 === 1);
      if (ways[axes].length === 0) assert.ok(said === null || said.key === "status.next_pair");
      else assert.ok(ways[axes].some(({ text, direction }) => said.parameters.way === text && said.choice === direction));
    });
  }
  assert.equal(straightOn([[], [], []], 0, PAIRS, false), null);
});

test("the sentence leads up and back before aside, and forward and down last, but never to a small way before a large one", () => {
  const said = (pair, shift_m, turn = 0) => {
    const axes = PAIRS.indexOf(pair);
    const toGo = { shift_m, turn_rad: [0, 0, turn], gripper: null };
    const ways = PAIRS.map((name, at) => leftToGo(toGo, name, (x, y) => modeInput(DEFAULTS, stateOf({ mode: "end_effector", axes: at }), welcomeOf(), x, y)));
    return straightOn(ways, axes, PAIRS, false).parameters.way;
  };
  assert.match(said("x-y", [-0.13, 0.23, 0]), / 13 cm/);
  assert.match(said("x-y", [0.13, 0.1, 0]), / 10 cm/);
  assert.match(said("x-y", [-0.006, 0.23, 0]), / 23 cm/);
  assert.match(said("z-yaw", [0, 0, 0.05], 1), /5.0 cm/);
  assert.match(said("z-yaw", [0, 0, -0.4], 0.3), /17°/);
});

test("learned motions are named where they lead nearer by more than 1 cm, without the distance of a straight line", () => {
  const toGo = { shift_m: [0.1, 0, 0], turn_rad: [0, 0, 0], gripper: null };
  const path = (...end) => [[0, 0, 0], end];
  const paths = { up: path(0.009, 0, 0), down: path(-0.1, 0, 0), left: null, right: path(0, 0.1, 0) };
  assert.equal(learnedOn(toGo, paths, false), null);
  const { key, parameters } = learnedOn(toGo, { ...paths, left: path(0.05, 0.02, 0) }, false);
  assert.deepEqual([key, parameters], ["status.go", { way: "Left" }]);
  assert.equal(awayWords(stateOf({ task: { outcome: null, to_go: toGo } })), "10 cm to go");
});
