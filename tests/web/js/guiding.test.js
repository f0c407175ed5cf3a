/** Guiding a real arm by hand from the Teach page, and connecting one again that is lost. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { sentenceOf, textOf } from "#pages/connection/sentence.js";
import { attachStop } from "#pages/connection/stop.js";
import { attachGuiding, guidingOf } from "#pages/teach/guiding.js";
import { elementsOf, FakeElement, FakeSocket, event, key, newBrowser, pass, pageOf, stateOf, welcomeOf } from "./browser.js";

let fakes;
let socket;
let parts;
let guiding;

const NAMES = ["check", "why", "doing", "task", "record", "recorded", "gripper", "open", "close"];
const says = (fields) => socket.says(stateOf({ you: true, phase: "disengaged", guiding: "offered", ...fields }));
const types = () => socket.taken().map(({ type, on, gripper }) => [type, on ?? gripper ?? null]);
const press = (part) => parts[part].dispatchEvent(new Event("click"));

beforeEach(() => {
  fakes = newBrowser();
  const connection = new Connection(null);
  socket = FakeSocket.newest;
  socket.opens();
  parts = elementsOf({ panel: "guiding", confirmed: "guiding-loaded", button: "guiding-begin", ...Object.fromEntries(NAMES.map((name) => [name, `guiding-${name}`])) });
  parts.confirmed.checked = true;
  parts.task.value = " wave ";
  guiding = attachGuiding(connection, { ask: (act) => act() });
  attachStop(connection, () => guiding());
  socket.says(welcomeOf({ gripper_width_m: 0.08 }));
  says({});
  socket.taken();
});

test("it is there only for an arm that can be guided, and asks first what only a person can see", () => {
  assert.equal(parts.panel.hidden, false);
  says({ guiding: null });
  assert.equal(parts.panel.hidden, true);
  const state = stateOf({ you: true, phase: "disengaged", guiding: "offered" });
  assert.equal(guidingOf(state, { waiting: false, confirmed: false }).does, null);
  assert.equal(guidingOf(state, { waiting: false, confirmed: true }).does, "begin");
  assert.equal(guidingOf({ ...state, phase: "ready" }, { waiting: false, confirmed: true }).why, "guiding.stop_first");
  assert.equal(guidingOf({ ...state, you: false, driver: "other" }, { waiting: false, confirmed: true }).why, "guiding.driver_only");
  assert.deepEqual(guidingOf({ ...state, guiding: "own" }, { waiting: false, confirmed: true }), { does: "begin", why: "guiding.own", records: true });
});

test("while the arm is guided the page says that it is there, and records and moves the gripper", () => {
  press("button");
  assert.deepEqual(types(), [["guide", true]]);
  says({ guiding: "on" });
  assert.equal(parts.doing.hidden, false);
  pass(500);
  assert.deepEqual(types(), [["guided", null], ["guided", null]]);
  press("record");
  const [{ type, on, task, by_hand }] = socket.taken();
  assert.deepEqual({ type, on, task, by_hand }, { type: "record", on: true, task: "wave", by_hand: true });
  press("close");
  assert.deepEqual(types(), [["guided", "close"]]);
  press("button");
  assert.deepEqual(types(), [["guide", false]]);
  pass(500);
  assert.deepEqual(types(), []);
});

test("leaving the page or hiding it ends guiding", () => {
  press("button");
  says({ guiding: "on" });
  socket.taken();
  fakes.window.dispatchEvent(event("pagehide"));
  assert.deepEqual(types(), [["guide", false]]);
});

test("after a Stop, or what else ends it, nothing asks for it again", () => {
  press("button");
  says({ guiding: "on" });
  socket.taken();
  key("keydown", "Space", { target: new FakeElement("button") });
  assert.deepEqual(types(), [["stop", null]]);
  says({ guiding: "offered" });
  pass(500);
  assert.deepEqual(types(), []);
});

test("an arm that is not connected is not said to need Enable", () => {
  const connection = { open: true, silenceMs: 0, engaged: false, drove: true, own: { has: () => false }, welcome: welcomeOf() };
  const page = pageOf({ canConnect: false });
  const reason = { code: "arm_off", parameters: {} };
  const text = (fields) => textOf(sentenceOf({ ...connection, state: stateOf({ lost: true, phase: "disengaged", reason, ...fields }) }, page));
  for (const fields of [{ you: true }, { driver: null }]) assert.equal(text(fields), "The arm is not connected.");
});

test("what it does is said to the person and to those who watch", () => {
  const connection = { open: true, silenceMs: 0, engaged: false, drove: true, own: { has: () => false }, welcome: welcomeOf() };
  const page = pageOf({ canEnable: false });
  const text = (fields) => textOf(sentenceOf({ ...connection, state: stateOf({ guiding: "on", phase: "disengaged", ...fields }) }, page));
  assert.match(text({ you: true }), /moved by hand/);
  assert.match(text({ you: false, driver: "x", driver_name: "Ada" }), /Ada is guiding/);
});
