/** Where the arm is slow, in words. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachZones } from "#pages/drive/zones.js";
import { elementsOf, newBrowser, stateOf, welcomeOf } from "./browser.js";

beforeEach(newBrowser);

test("zones are listed with their speeds, by the page's words or by their own names", () => {
  const { text } = elementsOf({ text: "zones" });
  const connection = Object.assign(new EventTarget(), { welcome: welcomeOf({ zones: [] }) });
  attachZones(connection);
  connection.dispatchEvent(new Event("welcome"));
  assert.ok(text.hidden);
  connection.welcome = welcomeOf({ zones: [{ name: "self", speed: 0.08 }, { name: "Tray 2", speed: 0.1 }] });
  connection.dispatchEvent(new Event("welcome"));
  assert.ok(!text.hidden);
  assert.equal(text.textContent, "Slow zones: body (at most 8 cm/s) and Tray 2 (at most 10 cm/s).");
});

test("what the arm keeps out of is listed after them, or alone", () => {
  const { text } = elementsOf({ text: "zones" });
  const zones = [{ name: "face", speed: 0.05 }];
  const connection = Object.assign(new EventTarget(), { welcome: welcomeOf({ zones, keep_out: ["table", "Wand"] }) });
  attachZones(connection);
  connection.dispatchEvent(new Event("welcome"));
  assert.equal(text.textContent, "Slow zones: face (at most 5 cm/s). The arm keeps out of: table and Wand.");
  connection.welcome = welcomeOf({ zones: [], keep_out: ["table"] });
  connection.dispatchEvent(new Event("welcome"));
  assert.ok(!text.hidden);
  assert.equal(text.textContent, "The arm keeps out of: table.");
});

test("what counts as held is said, and that a thing of unknown size does not count", () => {
  const { text } = elementsOf({ text: "zones" });
  const connection = Object.assign(new EventTarget(), { welcome: welcomeOf({ keep_out: ["table"] }), state: stateOf({ held: ["cup", "long spoon"] }) });
  attachZones(connection);
  connection.dispatchEvent(new Event("state"));
  assert.equal(text.textContent, "The arm keeps out of: table. Counts as part of the arm, because it holds it: cup and long spoon.");
  connection.state = stateOf({ gripper: { width_m: 0.03, holding: true, closing: true } });
  connection.dispatchEvent(new Event("state"));
  assert.match(text.textContent, /Nobody has said how large the thing in the gripper is/);
  connection.state = stateOf();
  connection.dispatchEvent(new Event("state"));
  assert.equal(text.textContent, "The arm keeps out of: table.");
});
