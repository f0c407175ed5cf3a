import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { DriveInput } from "#pages/inputs/drive_input.js";
import { FakeSocket, newBrowser, pass, stateOf } from "./browser.js";

let fakes;
let input;
let socket;
let halted;

const sent = (type) => socket.taken().filter((message) => !type || message.type === type);
const state = (fields) => socket.says(stateOf({ you: true, ...fields }));

/** Half a second of states and inputs, as when the arm is enabled. */
function drive(ms, fields) {
  for (let passed = 0; passed < ms; passed += 20) {
    state(fields);
    pass(20);
  }
}

beforeEach(() => {
  fakes = newBrowser();
  const connection = new Connection(null);
  socket = FakeSocket.newest;
  socket.opens();
  input = new DriveInput(connection, (x, y) => [x, y], (x, y) => [x, y]);
  halted = [];
  input.addEventListener("halted", (event) => halted.push(event.detail));
  state();
  socket.taken();
});

test("nothing is sent before the person enables the arm", () => {
  input.hold("dpad", 1, 0);
  drive(100);
  assert.deepEqual(sent(), []);
});

test("a neutral input goes ahead of enable", () => {
  input.enable();
  drive(100);
  const messages = sent();
  assert.deepEqual(messages[0].u, [0, 0]);
  assert.ok(messages.findIndex(({ type }) => type === "enable") >= 3);
});

test("a page that is hidden does not enable the arm", () => {
  fakes.document.hidden = true;
  input.enable();
  drive(100);
  assert.deepEqual(sent(), []);
});

test("inputs go out 50 times a second, and at once when a press begins or ends", () => {
  input.enable();
  drive(100, { phase: "ready" });
  sent();
  pass(1);
  input.hold("dpad", 1, 0);
  input.release("dpad");
  assert.deepEqual(sent("input").map(({ u }) => u), [[1, 0], [0, 0]]);
  drive(1000, { phase: "ready" });
  assert.equal(sent("input").length, 50);
});

test("a press moves the arm only while it is enabled and this page drives", () => {
  assert.ok(!input.live);
  input.enable();
  assert.ok(!input.live);
  drive(100, { phase: "ready" });
  assert.ok(input.live);
  state({ phase: "ready", you: false });
  assert.ok(!input.live);
});

test("the gripper is asked once, with the deflection as it is, and not before the arm is enabled", () => {
  assert.ok(!input.ask("close", "keyboard"));
  input.enable();
  drive(100, { phase: "ready" });
  sent();
  input.hold("dpad", 1, 0);
  assert.ok(input.ask("close", "keyboard"));
  drive(60, { phase: "moving" });
  const [held, asked, ...later] = sent("input");
  assert.deepEqual([held.gripper, asked.gripper, asked.u, asked.source], [null, "close", [1, 0], "dpad"]);
  assert.ok(asked.seq > held.seq);
  assert.deepEqual(later.map(({ gripper }) => gripper), [null, null, null]);
});

test("stop before enable has gone out leaves the arm alone", () => {
  input.enable();
  pass(30);
  input.drop();
  drive(200);
  assert.deepEqual(sent("enable"), []);
});

for (const [reason, happens] of [
  ["focus_lost", () => fakes.window.dispatchEvent(new Event("blur"))],
  ["page_closed", () => fakes.window.dispatchEvent(new Event("pagehide"))],
  ["page_hidden", () => {
    fakes.document.hidden = true;
    fakes.document.dispatchEvent(new Event("visibilitychange"));
  }],
]) {
  test(`${reason}: the arm is stopped, the person is told why, and no more inputs go out`, () => {
    input.enable();
    drive(100, { phase: "ready" });
    input.hold("pointer", 0, 1);
    sent();
    happens();
    const [neutral, stop, ...more] = sent();
    assert.deepEqual(neutral.u, [0, 0]);
    assert.equal(stop.type, "stop");
    assert.deepEqual(more, []);
    assert.deepEqual(halted, [null, reason]);
    drive(100, { phase: "disengaged" });
    assert.deepEqual(sent(), []);
  });
}

test("a page that does not drive stops nobody by losing the focus", () => {
  fakes.window.dispatchEvent(new Event("blur"));
  assert.deepEqual(sent(), []);
  assert.deepEqual(halted, []);
});

test("inputs end when the server has disengaged the arm", () => {
  input.enable();
  drive(100, { phase: "ready" });
  state({ phase: "disengaged" });
  sent();
  drive(100, { phase: "disengaged" });
  assert.ok(!input.flowing);
  assert.deepEqual(sent(), []);
});

test("an enable that is not answered is given up after 1.5 s", () => {
  input.enable();
  drive(1400, { phase: "disengaged" });
  assert.ok(input.flowing);
  drive(200, { phase: "disengaged" });
  assert.ok(!input.flowing);
});

test("a lost connection lets go of everything", () => {
  input.enable();
  drive(100, { phase: "ready" });
  input.hold("keyboard", 1, 0);
  socket.close();
  assert.ok(!input.flowing);
  assert.equal(input.source, null);
});

test("what opens the gripper is said 50 times a second while it is held, and that it was let go", () => {
  let held = true;
  assert.ok(input.holdOpen("pointer", () => held));
  drive(100, { phase: "disengaged" });
  const opening = sent("input");
  assert.ok(opening.length >= 4);
  assert.ok(opening.every(({ opens, u, gripper }) => opens && u.every((axis) => axis === 0) && gripper === null));
  held = false;
  drive(100, { phase: "disengaged" });
  assert.deepEqual(sent("input").map(({ opens }) => opens), [false]);
});

test("whatever makes the page doubtful, and Enable, end what opens the gripper", () => {
  for (const end of [() => input.halt("focus_lost"), () => input.drop(), () => (fakes.document.hidden = true), () => input.enable()]) {
    assert.ok(input.holdOpen("pointer", () => true));
    drive(60, { phase: "disengaged" });
    sent();
    end();
    drive(100, { phase: "disengaged" });
    assert.ok(sent("input").every(({ opens }) => !opens));
    fakes.document.hidden = false;
    input.drop();
  }
});

test("an enabled arm's gripper is not opened by holding", () => {
  state({ phase: "ready" });
  assert.ok(!input.holdOpen("pointer", () => true));
});
