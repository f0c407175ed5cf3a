import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { OwnPages } from "#pages/connection/own_pages.js";
import { sentenceOf, textOf } from "#pages/connection/sentence.js";
import { attachStatus, isTrouble } from "#pages/connection/status.js";
import { FakeElement, FakeSocket, newBrowser, pageOf, pass, stateOf, welcomeOf } from "./browser.js";

const ADA = { code: "stop_pressed_by", parameters: { name: "Ada", page: "ada" } };

let socket;
let line;
let text;
let status;

beforeEach(() => {
  newBrowser().document.getElementById = (id) => (id === "enable" ? new FakeElement() : null);
  const connection = new Connection(null);
  socket = FakeSocket.newest;
  [line, text] = [new FakeElement(), new FakeElement()];
  status = attachStatus({ line, text }, connection, { values: pageOf().values });
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

test("a driver who is cut off is told that the arm stopped; a watcher, that it may be moving", () => {
  settled({ phase: "moving", you: true, driver: "me" });
  socket.close();
  assert.deepEqual(settled(), ["lost", "The connection is lost, so the arm stopped. Trying again …"]);
  pass(500);
  FakeSocket.newest.opens();
  FakeSocket.newest.says(stateOf({ phase: "moving", driver: "ada", driver_name: "Ada" }));
  FakeSocket.newest.close();
  assert.deepEqual(settled(), ["lost", "The connection is lost. What you see is old: the arm may be moving. Trying again …"]);
});

test("a page that never heard of the arm says nothing of it", () => {
  socket.close();
  assert.deepEqual(settled(), ["lost", "The arm's computer cannot be reached. Trying again …"]);
});

test("a page that finds no room reads that, while it tries again too", () => {
  const full = { type: "refused", notice: { code: "full", parameters: { most: 16 } } };
  const words = "There is no room: 16 pages are open already. Close one of them; this page keeps trying.";
  socket.says(full);
  socket.close();
  assert.deepEqual(settled(), ["lost", words]);
  pass(500);
  FakeSocket.newest.opens();
  assert.deepEqual(settled(), ["lost", words]);
  FakeSocket.newest.says(welcomeOf());
  FakeSocket.newest.says(stateOf({ driver: "ada", driver_name: "Ada", phase: "moving" }));
  assert.equal(settled()[1], "Ada is moving the arm.");
});

test("what was known before the connection was lost is not shown after it", () => {
  settled({ phase: "ready" });
  socket.close();
  pass(500);
  FakeSocket.newest.opens();
  assert.deepEqual(settled(), ["connecting", "Connecting …"]);
});

test("a silent server is said within 0.8 s", () => {
  settled({ phase: "ready", you: true });
  pass(800);
  assert.equal(line.dataset.phase, "lost");
  assert.equal(text.textContent, "The arm's computer does not answer, so the arm stops by itself.");
});

test("a watcher of a silent server is not told that the arm stops", () => {
  settled({ phase: "moving", driver: "ada" });
  pass(800);
  assert.equal(text.textContent, "The arm's computer does not answer. What you see is old: the arm may be moving.");
});

test("why this page stopped the arm is said until the arm is enabled again", () => {
  status.halted("focus_lost");
  assert.equal(settled({ phase: "disengaged", you: true })[1], "Stopped: this window is no longer in front. Press Enable to move the arm.");
  assert.equal(settled({ phase: "ready", you: true })[0], "ready");
  // Another drives in between: what this page did is over.
  status.halted("focus_lost");
  settled({ phase: "ready", driver: "ada" });
  assert.equal(settled({ phase: "disengaged", you: true, reason: ADA })[1], "Ada pressed Stop. Press Enable to move the arm.");
});

test("what the server refused the page for is said until it is welcome again", () => {
  socket.says({ type: "refused", notice: { code: "page_refused", parameters: {} } });
  socket.close();
  assert.deepEqual(settled(), ["lost", "This page and the arm's computer do not understand each other. Load the page again."]);
  pass(500);
  FakeSocket.newest.opens();
  FakeSocket.newest.says(welcomeOf());
  FakeSocket.newest.close();
  assert.match(settled()[1], /cannot be reached/);
});

const LATE = { code: "input_late", parameters: { text: "No input came for more than 50 ms." } };
const note = (code, parameters = {}) => ({ code, parameters });
const DRIVER = { you: true, driver: "me", driver_name: "Bob" };
const WATCHER = { you: false, driver: "ada", driver_name: "Ada" };
const NOBODY = { you: false, driver: null, driver_name: null };
const CABLE = note("arm_lost", { text: "Check its cable." });
const MINE = { code: "stop_pressed_by", parameters: { name: "Guest 114", page: "me" } };

for (const [who, fields, words, page] of [
  [DRIVER, { phase: "ready" }, "Enabled: push to move."],
  [WATCHER, { phase: "ready" }, "Ada can move the arm now. You are watching."],
  [DRIVER, { phase: "ready", let_go_first: true }, "Let go of everything first, then push again."],
  [DRIVER, { phase: "moving" }, "Moving."],
  [WATCHER, { phase: "moving" }, "Ada is moving the arm."],
  [DRIVER, { phase: "moving", held_back: "clearance" }, "Moving slower than you ask: it is close to something."],
  [WATCHER, { phase: "moving", held_back: "clearance" }, "Ada is moving the arm, slower than asked: it is close to something."],
  [DRIVER, { phase: "moving", held_back: "zone", zone: "self" }, "Moving slower than you ask: it is in or near the zone “body”."],
  [WATCHER, { phase: "moving", held_back: "zone", zone: "Tray 2" }, "Ada is moving the arm, slower than asked: it is in or near the zone “Tray 2”."],
  [DRIVER, { phase: "moving", returning: true }, "Going back to the start. A push or Stop ends it."],
  [DRIVER, { phase: "moving", returning: true, held_back: "clearance" }, "Going back to the start, but held back: it is close to something."],
  [WATCHER, { phase: "moving", returning: true }, "The arm is going back to the start."],
  [DRIVER, { phase: "stopping", reason: ADA }, "Stopping. Ada pressed Stop."],
  [DRIVER, { phase: "stopping", reason: MINE }, "Stopping. You pressed Stop."],
  [WATCHER, { phase: "stopping", reason: MINE }, "Stopping. You pressed Stop."],
  [DRIVER, { reason: ADA }, "Ada pressed Stop. Press Enable to move the arm."],
  [WATCHER, { reason: ADA }, "Ada pressed Stop. Ada is driving; you are watching."],
  [WATCHER, { reason: MINE }, "You pressed Stop. Ada is driving; you are watching."],
  [WATCHER, { reason: MINE, asking: "me" }, "You pressed Stop. You have asked to drive: wait until Ada hands over."],
  [NOBODY, { reason: note("driver_gone", { name: "Ada", page: "ada" }) },
    "The driver's page has gone, so the arm stopped. Nobody is driving. Press Enable to drive."],
  [DRIVER, { reason: note("driver_gone", { name: "Bob", page: "me" }) },
    "Your page lost its connection, so the arm stopped. Press Enable to move the arm."],
  [DRIVER, { reason: note("handed_over", { name: "Ada", page: "ada" }) }, "Ada has handed over. Press Enable to move the arm."],
  [WATCHER, { reason: note("handed_over", { name: "Bob", page: "me" }) }, "You have handed over. Ada is driving; you are watching."],
  [WATCHER, { reason: note("driver_released", { name: "Bob", page: "me" }) }, "You have stopped driving. Ada is driving; you are watching."],
  [DRIVER, { reason: note("driver_changed") }, "You are driving now. Press Enable to move the arm."],
  [WATCHER, { reason: note("driver_changed") }, "Somebody else drives now. Ada is driving; you are watching."],
  [WATCHER, { reason: note("page_stopped", { name: "Ada", page: "ada" }) },
    "Ada's page stopped the arm: the page was left, or a control was lost. Ada is driving; you are watching."],
  [DRIVER, { reason: note("page_stopped", { name: "Bob", page: "me" }) }, "This page stopped the arm: it was left, or a control was lost. Press Enable to move the arm."],
  [DRIVER, { reason: LATE }, "Your computer was too slow for a moment, so the arm stopped. Press Enable to move the arm.", { late: "page" }],
  [DRIVER, { reason: LATE }, "The arm did not hear from you in time, so it stopped. The connection may be slow. Press Enable to move the arm."],
  [WATCHER, { reason: LATE },
    "The driver's computer or connection was too slow for a moment, so the arm stopped. Ada is driving; you are watching."],
  [DRIVER, { reason: ADA }, "Ada pressed Stop.", { canEnable: false }],
  [NOBODY, { reason: ADA }, "Ada pressed Stop.", { canEnable: false }],
  [DRIVER, { phase: "neutral_needed", reason: ADA }, "Ada pressed Stop. Let go of the stick, then press Enable."],
  [WATCHER, { phase: "neutral_needed", reason: ADA }, "Ada pressed Stop. Ada is driving; you are watching."],
  [DRIVER, { reason: ADA, note: note("stop_first") }, "Stop the arm first."],
  [WATCHER, { reason: ADA, note: note("stop_first") }, "Ada pressed Stop. Ada is driving; you are watching."],
  [WATCHER, { reason: ADA, note: note("let_go_first") }, "Ada pressed Stop. Ada is driving; you are watching."],
  [WATCHER, { phase: "ready", note: note("at_start") }, "The arm is back at the start."],
  [DRIVER, { reason: ADA }, "The arm is not enabled. Press Enable to move the arm.", { refused: true }],
  [NOBODY, { reason: ADA }, "The arm is not enabled. Nobody is driving. Press Enable to drive.", { refused: true }],
  [DRIVER, { reason: ADA }, "Ada pressed Stop. Confirm the points under “Before a real arm moves”, then press Enable.", { unconfirmed: true }],
  [NOBODY, { reason: ADA }, "Ada pressed Stop. Confirm the points under “Before a real arm moves”, then press Enable.", { unconfirmed: true }],
  [WATCHER, { reason: ADA }, "Ada pressed Stop. Ada is driving; you are watching.", { unconfirmed: true }],
  [DRIVER, { reason: CABLE, lost: true }, "The arm is not connected. Check its cable. Then press “Connect again”.", { unconfirmed: true }],
  [NOBODY, { reason: CABLE, lost: true }, "The arm is not connected. Check its cable. Then press “Connect again”.", { canEnable: false }],
  [DRIVER, { reason: CABLE, lost: true }, "The arm is not connected. Check its cable.", { canConnect: false }],
  [WATCHER, { phase: "moving" }, "You are watching. Press “Ask to drive” first.", { refused: true }],
  [WATCHER, { asking: "bob", asking_name: "Bob" }, "Ada is driving, and Bob has asked to drive already.", { refused: true }],
  [DRIVER, { phase: "ready", let_go_first: true, idle_left_s: 12 }, "Let go of everything first, then push again. The arm will be disabled in 15 s."],
  [DRIVER, { phase: "ready" }, "Push the stick to one side, and hold it. The arrow keys do the same.", { practice: "press" }],
  [DRIVER, { phase: "ready" }, "Push the stick to one side, and hold it.", { practice: "press", keys: false }],
  [DRIVER, { reason: LATE }, "Your computer was too slow for a moment, so the arm stopped. Press Enable to move the arm.", { practice: "press", late: "page" }],
  [DRIVER, { phase: "ready" }, "Push Right 16 cm.", { next: { key: "status.go", parameters: { way: "Right 16 cm" } } }],
]) {
  const about = who === DRIVER ? "the driver" : who === WATCHER ? "a watcher" : "a page while nobody drives";
  test(`what ${about} reads: ${words}`, () => {
    const own = new OwnPages();
    own.add("me");
    const state = stateOf({ ...who, ...fields });
    const connection = {
      open: true, silenceMs: 0, engaged: ["ready", "moving"].includes(state.phase), state, drove: who.you, own, welcome: welcomeOf(),
    };
    assert.equal(textOf(sentenceOf(connection, pageOf(page))), words);
  });
}

test("what somebody must look at the arm for is marked, and an ordinary stop is not", () => {
  assert.ok(isTrouble(stateOf({ reason: note("arm_emergency_stop") })));
  assert.ok(isTrouble(stateOf({ reason: ADA, note: note("arm_process_ended") })));
  assert.ok(!isTrouble(stateOf({ reason: ADA })));
  assert.ok(!isTrouble(stateOf({ phase: "moving", reason: note("arm_fault") })));
  assert.ok(!isTrouble(null));
});

test("a stop for a late input names what was too slow", () => {
  let slow = true;
  status.watch(() => pageOf({ slow }));
  settled({ phase: "ready", you: true });
  assert.match(settled({ phase: "disengaged", you: true, reason: LATE })[1], /^Your computer was too slow/);
  // What the page finds out later changes nothing.
  slow = false;
  assert.match(settled({ phase: "disengaged", you: true, reason: LATE })[1], /^Your computer was too slow/);
  settled({ phase: "ready", you: true });
  assert.match(settled({ phase: "disengaged", you: true, reason: LATE })[1], /^The arm did not hear from you in time/);
});

test("a page knows again after it was loaded anew that it was itself who pressed Stop", () => {
  socket.says(welcomeOf({ id: "before" }));
  const { own } = new Connection("");
  assert.ok(own.has("before"));
  assert.ok(!own.has("another"));
  assert.ok(!own.has(undefined));
});

test("a press that cannot move the arm says why, and for a moment only", () => {
  settled({ phase: "moving", driver: "ada", driver_name: "Ada" });
  status.refused();
  assert.equal(settled({ phase: "moving", driver: "ada", driver_name: "Ada" })[1], "You are watching. Press “Ask to drive” first.");
  for (let passed = 0; passed < 4000; passed += 200) settled({ phase: "moving", driver: "ada", driver_name: "Ada" });
  assert.equal(text.textContent, "Ada is moving the arm.");
});

test("a stop from before this page was there is nobody's", () => {
  const before = { phase: "disengaged", you: true, reason: LATE };
  assert.equal(settled(before)[1], "The arm is not enabled. Press Enable to move the arm.");
  assert.equal(settled({ ...before, reason: ADA })[1], "Ada pressed Stop. Press Enable to move the arm.");
  settled({ phase: "ready", you: true });
  assert.match(settled(before)[1], /^The arm did not hear from you in time/);
});

test("an arm that cannot be enabled is said to be so, however long ago that began", () => {
  assert.match(settled({ phase: "disengaged", you: true, reason: note("arm_emergency_stop") })[1], /^The emergency stop on the arm is pressed: release it first.$/);
});

test("what lasts shorter than 0.12 s is not announced", () => {
  settled({ phase: "ready" });
  const before = text.textContent;
  socket.close();
  pass(60);
  assert.equal(text.textContent, before);
});
