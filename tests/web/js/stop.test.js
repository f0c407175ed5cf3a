import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { attachStop } from "#pages/connection/stop.js";
import { event, FakeElement, FakeSocket, key, newBrowser, pass, stateOf } from "./browser.js";

let fakes;
let socket;
let dropped;

beforeEach(() => {
  fakes = newBrowser();
  const connection = new Connection(null);
  socket = FakeSocket.newest;
  socket.opens();
  socket.says(stateOf({ you: true, phase: "moving" }));
  socket.taken();
  dropped = 0;
  attachStop(connection, () => (dropped += 1));
});

const stops = () => socket.taken().filter(({ type }) => type === "stop").length;
const posts = () => fakes.fetch.mock.calls.map(({ arguments: [address, { method }] }) => `${method} ${address}`);

for (const code of ["Space", "Escape"]) {
  test(`${code} stops, whatever has the focus while the arm is enabled`, () => {
    for (const kind of ["", "button", "select", "a"]) key("keydown", code, { target: new FakeElement(kind) });
    assert.equal(stops(), 4);
    assert.equal(dropped, 4);
    assert.deepEqual(posts(), []);
  });
}

test("the Stop button stops on press, before it is let go", () => {
  fakes.window.dispatchEvent(event("pointerdown", { target: new FakeElement("#stop") }));
  assert.equal(stops(), 1);
});

test("a switch or a screen reader presses Stop without a pointer", () => {
  fakes.window.dispatchEvent(event("click", { target: new FakeElement("#stop"), detail: 0 }));
  fakes.window.dispatchEvent(event("click", { target: new FakeElement("#stop"), detail: 1 }));
  assert.equal(stops(), 1);
});

test("a press elsewhere does not stop", () => {
  fakes.window.dispatchEvent(event("pointerdown", { target: new FakeElement("button") }));
  assert.equal(stops(), 0);
});

test("Space writes in a text field and presses a button while the arm is not enabled; Escape stops still", () => {
  key("keydown", "Space", { target: new FakeElement("textarea") });
  assert.equal(stops(), 0);
  socket.says(stateOf({ phase: "disengaged" }));
  key("keydown", "Space", { target: new FakeElement("button") });
  assert.equal(stops(), 0);
  key("keydown", "Escape", { target: new FakeElement("textarea") });
  assert.equal(stops(), 1);
});

test("where the connection is silent or lost, Stop goes another way as well", () => {
  pass(300);
  key("keydown", "Escape");
  assert.equal(stops(), 1);
  socket.close();
  key("keydown", "Escape");
  assert.deepEqual(posts(), ["POST /stop", "POST /stop"]);
  assert.equal(dropped, 2);
});

test("a button that has the focus does not act when Space comes up after a stop", () => {
  socket.says(stateOf({ phase: "stopping" }));
  assert.ok(key("keyup", "Space").defaultPrevented);
  socket.says(stateOf({ phase: "disengaged" }));
  assert.ok(!key("keyup", "Space").defaultPrevented);
});

test("where Space is a switch it stops nothing and is left to scanning; Escape stops", () => {
  const others = new EventTarget();
  globalThis.window = others;
  const connection = new Connection("");
  FakeSocket.newest.opens();
  FakeSocket.newest.says(stateOf({ you: true, phase: "moving" }));
  FakeSocket.newest.taken();
  attachStop(connection, () => (dropped += 1), () => false);
  assert.ok(!key("keydown", "Space").defaultPrevented);
  assert.equal(dropped, 0);
  key("keydown", "Escape");
  assert.equal(dropped, 1);
  assert.deepEqual(FakeSocket.newest.taken().map(({ type }) => type), ["stop"]);
});
