import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { DriverLease, whoDrives } from "#pages/connection/driver_lease.js";
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

for (const [fields, askedHere, words] of [
  [{}, false, "Nobody is driving."],
  [{ you: true, driver: "me" }, false, "You are driving."],
  [{ you: true, driver: "me", watchers: 1 }, false, "You are driving; one other page watches."],
  [{ you: true, driver: "me", watchers: 3 }, false, "You are driving; 3 other pages watch."],
  [{ you: true, driver: "me", asking: "b", asking_name: "Bea" }, false, "You are driving. Bea asks to drive."],
  [{ you: true, driver: "me", asking: "b" }, false, "You are driving. Somebody asks to drive."],
  [{ driver: "b", driver_name: "Bea" }, false, "Bea is driving; you are watching and can stop the arm."],
  [{ driver: "b" }, true, "Somebody else is driving; you are watching and can stop the arm. You have asked to drive."],
]) {
  test(`who drives: ${words}`, () => assert.equal(whoDrives(stateOf(fields), askedHere), words));
}
