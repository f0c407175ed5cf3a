import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { attachStatus } from "#pages/connection/status.js";
import { FakeElement, FakeSocket, newBrowser, pass, stateOf, welcomeOf } from "./browser.js";

let socket;
let line;
let text;
let status;

beforeEach(() => {
  newBrowser();
  const connection = new Connection("");
  socket = FakeSocket.newest;
  [line, text] = [new FakeElement(), new FakeElement()];
  status = attachStatus({ line, text }, connection);
  socket.opens();
});

/** What the line says once it has settled, while states come. */
function settled(fields) {
  for (let passed = 0; passed < 200; passed += 20) {
    if (fields) socket.says(stateOf(fields));
    pass(20);
  }
  return [line.dataset.phase, text.textContent];
}

test("a page that has heard nothing yet is connecting", () => {
  assert.deepEqual(settled(), ["connecting", "Connecting …"]);
});

test("a lost connection is said, with what the arm does", () => {
  settled({ phase: "ready" });
  socket.close();
  assert.deepEqual(settled(), ["lost", "Connection lost. The arm has stopped. Reconnecting …"]);
});

test("what was known before the connection was lost is not shown after it", () => {
  settled({ phase: "ready" });
  socket.close();
  pass(500);
  FakeSocket.newest.opens();
  assert.deepEqual(settled(), ["connecting", "Connecting …"]);
});

test("a silent server is said within 0.8 s", () => {
  settled({ phase: "ready" });
  pass(800);
  assert.equal(line.dataset.phase, "lost");
  assert.match(text.textContent, /does not answer/);
});

test("why this page stopped the arm is said until the arm is enabled again", () => {
  status.halted("focus_lost");
  assert.equal(settled({ phase: "disengaged" })[1], "Stopped: this window lost the focus. Press Enable to go on.");
  assert.equal(settled({ phase: "ready" })[0], "ready");
});

test("what the server refused the page for is said until it is welcome again", () => {
  socket.says({ type: "refused", why: "This is not what a page may send." });
  socket.close();
  assert.deepEqual(settled(), ["lost", "This is not what a page may send."]);
  pass(500);
  FakeSocket.newest.opens();
  FakeSocket.newest.says(welcomeOf());
  FakeSocket.newest.close();
  assert.match(settled()[1], /Connection lost/);
});

test("what lasts shorter than 0.12 s is not announced", () => {
  settled({ phase: "ready" });
  const before = text.textContent;
  socket.close();
  pass(60);
  assert.equal(text.textContent, before);
});
