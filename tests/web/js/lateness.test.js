import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { attachDialogs, dialogIsOpen } from "#pages/inputs/dialogs.js";
import { DriveInput } from "#pages/inputs/drive_input.js";
import { Lateness } from "#pages/inputs/lateness.js";
import { paced } from "#pages/inputs/paced.js";
import { FakeSocket, newBrowser, pass, stateOf } from "./browser.js";

let fakes;

beforeEach(() => {
  fakes = newBrowser();
});

/** Inputs so far apart, ms, for so long. */
function beats(lateness, apart, forMs) {
  for (let passed = 0; passed < forMs; passed += apart) {
    pass(apart);
    lateness.beat();
  }
}

test("a page that keeps up draws whenever it likes", () => {
  const lateness = new Lateness();
  beats(lateness, 20, 3000);
  assert.equal(lateness.frameGapMs, 0);
  assert.ok(!lateness.wasSlow);
});

test("a page that is late draws less, ever less, and more again once it keeps up", () => {
  const lateness = new Lateness();
  lateness.beat();
  beats(lateness, 60, 60);
  const first = lateness.frameGapMs;
  assert.ok(first > 0);
  beats(lateness, 60, 120);
  assert.ok(lateness.frameGapMs > first);
  beats(lateness, 60, 6000);
  assert.ok(lateness.frameGapMs <= 500, "it still draws twice a second");
  beats(lateness, 20, 30_000);
  assert.equal(lateness.frameGapMs, 0);
});

test("a page knows for a moment that it was too slow, also from inputs that have ceased", () => {
  const lateness = new Lateness();
  lateness.beat();
  beats(lateness, 130, 130);
  assert.ok(lateness.wasSlow);
  pass(3000);
  lateness.rest();
  const other = new Lateness();
  beats(other, 20, 200);
  assert.ok(!other.wasSlow);
  pass(130);
  assert.ok(other.wasSlow);
  other.rest();
  pass(5000);
  assert.ok(!other.wasSlow);
});

test("what is paced is done at once after a rest, also where it was asked for in vain before", () => {
  const done = [];
  let moves = true;
  const draw = paced(() => {
    if (moves) done.push(performance.now());
    return moves;
  }, () => 100);
  for (let passed = 0; passed < 500; passed += 20) {
    draw();
    pass(20);
  }
  assert.ok(done.length > 3);
  assert.ok(done.slice(1).every((at, index) => at - done[index] >= 100));
  moves = false;
  for (let passed = 0; passed < 490; passed += 70) {
    pass(70);
    draw();
  }
  moves = true;
  draw();
  assert.equal(done.at(-1), performance.now());
});

/** A page that drives an enabled arm. */
function driving() {
  const connection = new Connection("");
  const socket = FakeSocket.newest;
  socket.opens();
  const input = new DriveInput(connection, (x, y) => [x, y], (x, y) => [x, y]);
  const state = (fields) => socket.says(stateOf({ you: true, phase: "ready", ...fields }));
  state({ phase: "disengaged" });
  input.enable();
  for (let passed = 0; passed < 100; passed += 20) {
    state();
    pass(20);
  }
  socket.taken();
  return { connection, socket, input, state };
}

test("an input that is due goes out before other work, and none that is not due", () => {
  const { socket, input, state } = driving();
  // The timer is held up, as by a long task.
  clearInterval(input._timer);
  pass(25);
  state();
  assert.equal(socket.taken().length, 1);
  state();
  input.goFirst();
  assert.equal(socket.taken().length, 0);
});

test("inputs that go first are no more than others: the server would hang up on too many", () => {
  const { socket, input, state } = driving();
  for (let passed = 0; passed < 1000; passed += 1) {
    pass(1);
    if (passed % 20 === 7) state();
    input.goFirst();
  }
  const count = socket.taken().length;
  assert.ok(count >= 45 && count <= 55, `${count} inputs in a second`);
});

test("what goes on by itself is let go where the stick means something else; what is held is not", () => {
  const { input, state } = driving();
  input.hold("dpad", 1, 0, true);
  state({ let_go_first: true });
  assert.equal(input.source, null);
  input.hold("pointer", 1, 0);
  state({ let_go_first: true });
  assert.equal(input.source, "pointer");
});

test("a dialog that opens stops the arm, however it opens, and a second one stops nobody again", () => {
  const dialogs = [1, 2].map(() => ({ open: false, localName: "dialog" }));
  let changed = () => {};
  fakes.document.getElementsByTagName = () => dialogs;
  fakes.document.querySelector = () => dialogs.find(({ open }) => open) ?? null;
  fakes.document.documentElement = {};
  globalThis.MutationObserver = class {
    constructor(callback) {
      changed = callback;
    }

    observe() {}
  };
  const halted = [];
  attachDialogs({ halt: (why) => halted.push(why) });
  changed();
  dialogs[1].open = true;
  changed();
  dialogs[0].open = true;
  changed();
  assert.deepEqual(halted, ["dialog_opened"]);
  assert.ok(dialogIsOpen());
  dialogs[0].open = dialogs[1].open = false;
  changed();
  assert.ok(!dialogIsOpen());
  dialogs[0].open = true;
  changed();
  assert.equal(halted.length, 2);
});
