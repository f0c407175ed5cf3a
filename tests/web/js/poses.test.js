/** Saved poses, and what is confirmed before a real arm is enabled. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachChecklist } from "#pages/drive/checklist.js";
import { attachPoses, goingOf, savesOf } from "#pages/drive/poses.js";
import { elementsOf, newBrowser, stateOf, welcomeOf } from "./browser.js";

beforeEach(newBrowser);

const DRIVING = { driving: true, engaged: true };

test("the arm goes to a pose only while it is enabled, at rest and let go, and says why not", () => {
  const why = (fields, connection = DRIVING) => goingOf({ ...connection, state: stateOf({ phase: "ready", ...fields }) });
  assert.equal(why({}), "help");
  assert.equal(why({ phase: "moving" }), "let_go");
  assert.equal(why({ let_go_first: true }), "let_go");
  assert.equal(why({ returning: true }), "on");
  assert.equal(why({}, { driving: true, engaged: false }), "enable_first");
  assert.equal(why({}, { driving: false, engaged: false }), "driver_only");
  assert.equal(goingOf({ ...DRIVING, state: stateOf({ phase: "ready" }) }), "help");
});

test("a pose is saved while the arm stands still, enabled or not, by the person who drives", () => {
  assert.ok(savesOf({ driving: true, state: stateOf({ phase: "disengaged" }) }));
  assert.ok(!savesOf({ driving: true, state: stateOf({ phase: "moving" }) }));
  assert.ok(!savesOf({ driving: false, state: stateOf({ phase: "ready" }) }));
});

test("a real arm is enabled once everything was confirmed, a simulated one at once", () => {
  const { panel, facts, ...named } = elementsOf({
    panel: "checklist", facts: "checklist-facts", stop: "checklist-stop", area: "checklist-area", payload: "checklist-payload",
  });
  const boxes = Object.values(named);
  for (const box of boxes) box.checked = false;
  const connection = Object.assign(new EventTarget(), { welcome: welcomeOf({ real: null }) });
  const checklist = attachChecklist(connection);
  assert.ok(checklist.done());
  connection.welcome = welcomeOf({ real: { facts: [["firmware", "2.1"]], shadow: false } });
  const told = [];
  connection.send = (message) => told.push(message.arm_start);
  connection.state = stateOf({ arm_start: 0, lost: false });
  connection.dispatchEvent(new Event("welcome"));
  connection.dispatchEvent(new Event("state"));
  assert.ok(!checklist.done());
  assert.deepEqual(told, [], "nothing is confirmed for a person");
  assert.equal(checklist.choices().length, 3);
  for (const box of boxes) box.checked = true;
  assert.ok(checklist.done());
  assert.deepEqual(checklist.choices(), []);
  boxes[2].dispatchEvent(new Event("change"));
  assert.deepEqual(told, [0]);
  connection.dispatchEvent(new Event("welcome"));
  connection.dispatchEvent(new Event("state"));
  assert.deepEqual(told, [0, 0], "the server does not know this page's new connection");
  connection.state = stateOf({ lost: true, arm_start: 1 });
  connection.dispatchEvent(new Event("state"));
  assert.ok(panel.hidden, "an arm that is not connected is connected first");
  connection.state = stateOf({ lost: false, arm_start: 1 });
  connection.dispatchEvent(new Event("state"));
  connection.dispatchEvent(new Event("welcome"));
  connection.dispatchEvent(new Event("state"));
  assert.deepEqual(told, [0, 0]);
  assert.equal(checklist.choices().length, 3, "it may have been moved, or carry something else now");
  assert.ok(!panel.hidden);
});

test("the robot's own poses come before saved ones, and cannot be deleted", () => {
  const sent = [];
  const parts = elementsOf({ panel: "poses-panel", list: "poses", why: "poses-why", name: "pose-name", save: "pose-save" });
  parts.panel.hidePopover = () => {};
  parts.list.querySelectorAll = () => [];
  const connection = Object.assign(new EventTarget(), {
    ...DRIVING, state: stateOf({ phase: "ready", you: true }), welcome: welcomeOf({ poses: ["home", "tuck"] }),
    poses: { names: ["Drink"], problem: null }, send: (message) => sent.push(message),
  });
  const poses = attachPoses(connection);
  assert.deepEqual(parts.list.children.map((row) => row.children.length), [1, 1, 2]);
  for (const row of parts.list.children) row.children[0].dispatchEvent(new Event("click"));
  assert.deepEqual(sent, [
    { type: "to_pose", name: "Home", built_in: "home" },
    { type: "to_pose", name: "Tuck", built_in: "tuck" },
    { type: "to_pose", name: "Drink", built_in: null },
  ]);
  assert.equal(poses().length, 3);
});
