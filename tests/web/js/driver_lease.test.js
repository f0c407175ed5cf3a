import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { DriverLease, whoAsks, whoDrives } from "#pages/connection/driver_lease.js";
import { FakeSocket, newBrowser, pass, stateOf } from "./browser.js";

let socket;
let lease;
let acted;
const act = () => (acted += 1);
const asked = () => socket.taken().filter(({ type }) => type === "ask_to_drive").length;

beforeEach(() => {
  newBrowser();
  const connection = new Connection(null);
  socket = FakeSocket.newest;
  socket.opens();
  lease = new DriverLease(connection);
  acted = 0;
});

test("the page that drives acts at once, without asking", () => {
  socket.says(stateOf({ you: true, driver: "me" }));
  lease.ask(act);
  assert.equal(acted, 1);
  assert.equal(asked(), 0);
});

test("where nobody drives, one press asks to drive and then acts, once", () => {
  socket.says(stateOf());
  lease.ask(act);
  assert.equal(asked(), 1);
  assert.equal(acted, 0);
  socket.says(stateOf({ you: true, driver: "me" }));
  socket.says(stateOf({ you: true, driver: "me" }));
  assert.equal(acted, 1);
});

test("where somebody else drives, a press asks them and does nothing later by itself", () => {
  socket.says(stateOf({ driver: "other" }));
  lease.ask(act);
  assert.equal(asked(), 1);
  socket.says(stateOf({ you: true, driver: "me" }));
  assert.equal(acted, 0);
});

test("an answer that takes longer than a second finds nobody waiting", () => {
  socket.says(stateOf());
  lease.ask(act);
  pass(1100);
  socket.says(stateOf({ you: true, driver: "me" }));
  assert.equal(acted, 0);
});

test("Stop takes back what waits", () => {
  socket.says(stateOf());
  lease.ask(act);
  lease.forget();
  socket.says(stateOf({ you: true, driver: "me" }));
  assert.equal(acted, 0);
});

for (const [fields, asks, words] of [
  [{}, null, "Nobody is driving."],
  [{ you: true, driver: "me" }, null, "You are driving."],
  [{ you: true, driver: "me", watchers: 1 }, null, "You are driving; one other page watches."],
  [{ you: true, driver: "me", watchers: 3 }, null, "You are driving; 3 other pages watch."],
  [{ you: true, driver: "me", asking: "b", asking_name: "Bea" }, "another", "You are driving. Bea asks to drive."],
  [{ you: true, driver: "me", asking: "b" }, "another", "You are driving. Somebody asks to drive."],
  [{ driver: "b", driver_name: "Bea" }, null, "Bea is driving; you are watching and can stop the arm."],
  [{ driver: "b", driver_name: "Bea", asking: "me" }, "you",
    "Bea is driving; you are watching and can stop the arm. You have asked to drive: wait until Bea hands over."],
  [{ driver: "b", driver_name: "Bea", asking: "c", asking_name: "Cy" }, "another",
    "Bea is driving; you are watching and can stop the arm. Cy has asked to drive already."],
]) {
  test(`who drives: ${words}`, () => {
    const state = stateOf(fields);
    assert.equal(whoAsks(state, "me"), asks);
    assert.equal(whoDrives(state, asks), words);
  });
}
