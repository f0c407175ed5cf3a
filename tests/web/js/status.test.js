import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { attachStatus, statusOf } from "#pages/connection/status.js";
import { FakeElement, FakeSocket, newBrowser, pass, stateOf, welcomeOf } from "./browser.js";

const ADA = { code: "stop_pressed_by", parameters: { name: "Ada" } };

let socket;
let line;
let text;
let status;

beforeEach(() => {
  newBrowser();
  const connection = new Connection(null);
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
  assert.equal(settled({ phase: "disengaged" })[1], "Stopped: this window lost the focus. Press Enable to continue.");
  assert.equal(settled({ phase: "ready" })[0], "ready");
});

test("what the server refused the page for is said until it is welcome again", () => {
  socket.says({ type: "refused", notice: { code: "page_refused", parameters: {} } });
  socket.close();
  assert.deepEqual(settled(), ["lost", "The page sent a message that the server does not accept."]);
  pass(500);
  FakeSocket.newest.opens();
  FakeSocket.newest.says(welcomeOf());
  FakeSocket.newest.close();
  assert.match(settled()[1], /Connection lost/);
});

for (const [fields, canEnable, words] of [
  [{ phase: "ready" }, true, "Enabled: push to move."],
  [{ phase: "moving" }, true, "Moving."],
  [{ phase: "moving", held_back: "clearance" }, true, "Moving slower than you ask: it is close to something."],
  [{ phase: "stopping", reason: ADA }, true, "Stopping. Ada pressed Stop."],
  [{ phase: "disengaged", reason: ADA }, true, "Ada pressed Stop. Press Enable to move the arm."],
  [{ phase: "disengaged", reason: ADA }, false, "Ada pressed Stop."],
  [{ phase: "neutral_needed", reason: ADA }, true, "Ada pressed Stop. Let go of the stick, then press Enable."],
  [{ phase: "disengaged", reason: ADA, note: { code: "stop_first", parameters: {} } }, true, "Stop the arm first."],
]) {
  test(`the arm's state in words: ${words}`, () => {
    const connection = { open: true, silenceMs: 0, engaged: false, state: stateOf(fields) };
    assert.equal(statusOf(connection, { halted: null, refused: "", canEnable }).text, words);
  });
}

test("what lasts shorter than 0.12 s is not announced", () => {
  settled({ phase: "ready" });
  const before = text.textContent;
  socket.close();
  pass(60);
  assert.equal(text.textContent, before);
});
