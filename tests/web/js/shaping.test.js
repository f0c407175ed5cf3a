import assert from "node:assert/strict";
import { test } from "node:test";

import { modeInput, shape } from "#pages/inputs/shaping.js";
import { DEFAULTS as USUAL } from "#pages/settings/settings.js";

const DEFAULTS = { ...USUAL, sensitivity: 1 };

const near = (found, wanted) => {
  assert.equal(found.length, wanted.length);
  found.forEach((value, axis) => assert.ok(Math.abs(value - wanted[axis]) < 1e-9, `${found} is not ${wanted}`));
};

test("small pushes are ignored, and a full push is full", () => {
  near(shape({ ...DEFAULTS, deadZone: 0.2 }, 0.2, 0), [0, 0]);
  near(shape({ ...DEFAULTS, deadZone: 0.2 }, 0.1, -0.1), [0, 0]);
  near(shape({ ...DEFAULTS, deadZone: 0.2 }, 1, 0), [1, 0]);
  near(shape({ ...DEFAULTS, deadZone: 0.2 }, 0, -1), [0, -1]);
});

test("the input grows from zero at the edge of the dead zone", () => {
  const just = shape({ ...DEFAULTS, deadZone: 0.2 }, 0.21, 0)[0];
  assert.ok(just > 0 && just < 0.02);
  near(shape({ ...DEFAULTS, deadZone: 0.2 }, 0.6, 0), [0.5, 0]);
});

test("a corner of the pad is full along both axes, and nothing exceeds 1", () => {
  near(shape(DEFAULTS, 1, 1), [1, 1]);
  for (let angle = 0; angle < 360; angle += 7) {
    const [x, y] = [Math.cos(angle), Math.sin(angle)];
    for (const value of shape(DEFAULTS, x, y)) assert.ok(Math.abs(value) <= 1);
  }
});

test("a push keeps its direction through the dead zone", () => {
  const [right, up] = shape(DEFAULTS, 0.6, 0.3);
  assert.ok(Math.abs(right - 2 * up) < 1e-9);
});

test("sensitivity scales, inverting mirrors, swapping exchanges the axes", () => {
  near(shape({ ...DEFAULTS, deadZone: 0, sensitivity: 0.5 }, 1, 0), [0.5, 0]);
  near(shape({ ...DEFAULTS, deadZone: 0, invertX: true }, 1, 0.5), [-1, 0.5]);
  near(shape({ ...DEFAULTS, deadZone: 0, invertY: true }, 1, 0.5), [1, -0.5]);
  near(shape({ ...DEFAULTS, deadZone: 0, swapAxes: true }, 1, 0.5), [0.5, 1]);
});

test("a run with one axis is sent left and right alone", () => {
  near(modeInput(DEFAULTS, { mode: "latent", axes: 0 }, { latent_dim: 1 }, 0.5, 1), shape(DEFAULTS, 0.5, 1).slice(0, 1));
  assert.equal(modeInput(DEFAULTS, { mode: "assisted", axes: 0 }, { latent_dim: 2 }, 0, 1).length, 2);
});

test("in straight lines, up pushes away from the person and right to their right, wherever they sit", () => {
  const across = { mode: "end_effector", axes: 0 };
  near(modeInput({ ...DEFAULTS, seat: "facing" }, across, null, 0, 1), [-1, 0]);
  near(modeInput({ ...DEFAULTS, seat: "behind" }, across, null, 0, 1), [1, 0]);
  near(modeInput({ ...DEFAULTS, seat: "facing" }, across, null, 1, 0), [0, 1]);
  near(modeInput({ ...DEFAULTS, seat: "behind" }, across, null, 1, 0), [0, -1]);
});

test("height does not depend on where the person sits", () => {
  for (const seat of ["facing", "behind"]) {
    near(modeInput({ ...DEFAULTS, seat }, { mode: "end_effector", axes: 1 }, null, 0, 1), [1, 0]);
  }
});

test("rest is sent as plain zeros", () => {
  for (const mode of ["latent", "end_effector"]) {
    for (const value of modeInput(DEFAULTS, { mode, axes: 0 }, { latent_dim: 2 }, 0, 0)) assert.ok(Object.is(value, 0));
  }
});
