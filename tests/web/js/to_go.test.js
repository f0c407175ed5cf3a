/** What is left of the way is told in the person's own directions, and driving them comes to an end there. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { DIRECTIONS } from "#pages/inputs/deflection.js";
import { modeInput } from "#pages/inputs/shaping.js";
import { awayWords } from "#pages/drive/task_words.js";
import { leftToGo } from "#pages/drive/to_go.js";
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

test("the step tells the turn apart from the distance, and what the gripper is to do", () => {
  const step = { kind: "poured", thing: "bowl" };
  const welcome = welcomeOf({ task: { name: "pour", seed: 0, choices: [], choice: 0, steps: [step] } });
  const at = (to_go) => awayWords(welcome, stateOf({ task: { choice: 0, done: 0, outcome: null, why: null, time_s: 0, to_go } }));
  assert.equal(at({ shift_m: [0.03, 0.04, 0], turn_rad: [0, 0.9, 0], gripper: null }), "5 cm, turn 52°");
  assert.equal(at({ shift_m: [0.03, 0.04, 0], turn_rad: [0, 0.1, 0], gripper: null }), "5 cm to go");
  assert.equal(at({ ...TO_GO, gripper: "close" }), "Close the gripper now");
});
