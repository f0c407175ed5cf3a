import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Deflection } from "#pages/inputs/deflection.js";
import { Scanner } from "#pages/inputs/scanner.js";
import { Settings } from "#pages/settings/settings.js";
import { newBrowser, pass } from "./browser.js";

let input;
let settings;
let scanner;
let done;

function choices(...ids) {
  return ids.map((id) => ({ id, label: id, act: () => done.push(id) }));
}

const lit = () => scanner.choices[scanner.lit].id;

beforeEach(() => {
  newBrowser();
  input = new Deflection();
  settings = new Settings();
  settings.change({ panel: "switch", dwellS: 1, acceptS: 0, releaseS: 0 });
  done = [];
  scanner = new Scanner(input, settings);
  scanner.offer(choices("up", "down", "mode", "stop"));
});

test("with one switch choices light up in turn, and begin again after the last", () => {
  const seen = [];
  for (let turn = 0; turn < 5; turn += 1) {
    seen.push(lit());
    pass(1000);
  }
  assert.deepEqual(seen, ["up", "down", "mode", "stop", "up"]);
});

test("with two switches nothing lights up by itself", () => {
  settings.change({ switches: "2" });
  pass(5000);
  assert.equal(lit(), "up");
  scanner.next();
  assert.equal(lit(), "down");
});

test("nothing lights up while the person steers with something else", () => {
  settings.change({ panel: "stick" });
  pass(5000);
  assert.equal(lit(), "up");
});

test("a direction moves until the next press, and the light waits meanwhile", () => {
  pass(1000);
  scanner.choose();
  assert.deepEqual([input.x, input.y, input.source, input.latched], [0, -1, "switch", true]);
  assert.equal(scanner.moving, "down");
  pass(5000);
  assert.equal(lit(), "down");
  scanner.choose();
  assert.equal(input.source, null);
  assert.equal(scanner.moving, null);
  pass(1000);
  assert.equal(lit(), "mode");
});

test("other choices act once", () => {
  scanner.next();
  scanner.next();
  scanner.choose();
  assert.deepEqual(done, ["mode"]);
  assert.equal(input.source, null);
});

test("a direction does not move while another way is pressed", () => {
  input.hold("keyboard", 1, 0);
  scanner.choose();
  assert.equal(scanner.moving, null);
  assert.deepEqual([input.x, input.y], [1, 0]);
});

for (const scan of ["auto", "inverse", "step"]) {
  test(`a press just after the arm stopped by itself was meant to stop it, and chooses nothing: ${scan}`, () => {
    settings.change({ scan });
    scanner.choose();
    input.neutral();
    scanner.offer(choices("enable", "mode"));
    scanner.press(0, true);
    pass(500);
    scanner.press(0, false);
    pass(4000);
    assert.deepEqual(done, []);
    scanner.lit = 0;
    scanner.choose();
    assert.deepEqual(done, ["enable"]);
  });
}

test("after a motion that ended by itself the light waits as long as a press means nothing, and begins at what is best by then", () => {
  const directions = (best) => ["up", "down", "left", "stop"].map((id) => ({ id, label: id, first: id === best }));
  scanner.offer(directions("down"));
  scanner.choose();
  input.neutral();
  scanner.offer(directions("left"));
  assert.equal(lit(), "down");
  pass(790);
  assert.equal(lit(), "down");
  pass(20);
  assert.equal(lit(), "left");
});

test("the light goes on at what brings the task on, where that has become another choice", () => {
  const choices = (best) => ["up", "down", "left", "gripper", "stop"].map((id) => ({ id, label: id, first: id === best, act: () => {} }));
  scanner.offer([]);
  scanner.offer(choices("gripper"));
  scanner.choose();
  pass(500);
  scanner.offer(choices("down"));
  assert.equal(lit(), "gripper");
  pass(1000);
  assert.equal(lit(), "down");
  pass(1000);
  assert.equal(lit(), "left");
});

test("other choices begin at the first one; the same ones leave the light where it is", () => {
  scanner.next();
  scanner.offer(choices("up", "down", "mode", "stop"));
  assert.equal(lit(), "down");
  scanner.offer(choices("enable", "mode"));
  assert.equal(lit(), "enable");
});

test("a choice that is called otherwise stays lit, and is taken as it is called", () => {
  scanner.next();
  let painted = 0;
  scanner.addEventListener("change", () => (painted += 1));
  const renamed = choices("up", "down", "mode", "stop");
  renamed[1].label = "lower";
  scanner.offer(renamed);
  assert.equal(scanner.choices[scanner.lit].label, "lower");
  assert.equal(painted, 1);
});

test("a gamepad's first button chooses, and its second goes on only with two switches", () => {
  assert.equal(scanner.press(1, true), false);
  settings.change({ switches: "2" });
  assert.equal(scanner.press(1, true), true);
  assert.equal(lit(), "down");
  assert.equal(scanner.press(0, true), true);
  assert.equal(scanner.press(0, false), true);
  assert.equal(scanner.moving, "down");
  settings.change({ panel: "stick" });
  assert.equal(scanner.press(0, true), false);
});

test("with long lists by rows a row is chosen first, Stop stands outside the rows, and Back leads to them", () => {
  settings.change({ rows: true });
  scanner.offer(choices("up", "down", "left", "right", "gripper", "mode", "stop", "more"));
  assert.deepEqual(scanner.choices.map(({ id }) => id), ["row-up", "stop", "row-gripper"]);
  assert.equal(scanner.choices[2].label, "gripper, mode, more");
  scanner.choose();
  assert.deepEqual(scanner.choices.map(({ id }) => id), ["up", "down", "left", "right", "stop", "row-up-back"]);
  pass(1000);
  scanner.choose();
  assert.equal(scanner.moving, "down");
  scanner.choose();
  assert.equal(lit(), "down");
  pass(4000);
  scanner.choose();
  assert.equal(lit(), "row-up");
  scanner.offer(choices("enable", "stop"));
  assert.equal(lit(), "enable");
});

test("the light begins at the direction that brings the task on, also after a motion, and no place changes", () => {
  const directions = (best) => ["up", "down", "left", "stop"].map((id) => ({ id, label: id, first: id === best }));
  scanner.offer([]);
  scanner.offer(directions("left"));
  assert.equal(lit(), "left");
  pass(2000);
  assert.equal(lit(), "up");
  scanner.offer(directions("down"));
  assert.equal(lit(), "up");
  scanner.choose();
  assert.equal(scanner.moving, "up");
  scanner.choose();
  assert.deepEqual([lit(), scanner.choices.map(({ id }) => id)], ["down", ["up", "down", "left", "stop"]]);
});
