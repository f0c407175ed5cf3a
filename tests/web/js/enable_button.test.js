import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachEnableButton, enableButtonOf } from "#pages/connection/enable_button.js";
import { wayBackOf } from "#pages/drive/way_back.js";
import { FakeElement, newBrowser, stateOf, welcomeOf } from "./browser.js";

beforeEach(newBrowser);

const WATCHING = { driver: "ada", driver_name: "Ada" };
const connectionOf = (fields, more = {}) => Object.assign(new EventTarget(), {
  open: true, engaged: ["ready", "moving"].includes(fields?.phase), driving: Boolean(fields?.you),
  state: fields && stateOf(fields), welcome: welcomeOf(), ...more,
});

for (const [about, connection, label, does] of [
  ["not connected", connectionOf({}, { open: false }), "layout.enable", null],
  ["not heard yet", connectionOf(null), "layout.enable", null],
  ["driving", connectionOf({ you: true, driver: "me" }), "layout.enable", "enable"],
  ["driving, enabled", connectionOf({ you: true, driver: "me", phase: "ready" }), "layout.enable", null],
  ["nobody drives", connectionOf({}), "layout.enable", "enable"],
  ["the arm is not connected", connectionOf({ you: true, driver: "me", lost: true }), "layout.enable", null],
  ["watching", connectionOf(WATCHING), "driver.ask", "ask"],
  ["watching a moving arm", connectionOf({ ...WATCHING, phase: "moving" }), "driver.ask", "ask"],
  ["has asked", connectionOf({ ...WATCHING, asking: "me" }), "driver.asked_button", null],
  ["another has asked", connectionOf({ ...WATCHING, asking: "bob" }), "driver.ask", null],
]) {
  test(`the button next to Stop, ${about}: ${label}, ${does}`, () => assert.deepEqual(enableButtonOf(connection), { label, does }));
}

test("a press does what the button says, and nothing where it is disabled", () => {
  const button = Object.assign(new FakeElement(), {
    attributes: {}, getAttribute(name) { return this.attributes[name] ?? null; },
    setAttribute(name, value) { this.attributes[name] = value; }, removeAttribute(name) { delete this.attributes[name]; },
  });
  const done = [];
  const connection = connectionOf({ you: true, driver: "me" }, { send: (message) => done.push(message.type) });
  attachEnableButton(button, connection, () => done.push("enable"));
  const press = (state) => {
    connection.state = stateOf(state);
    connection.engaged = state.phase === "ready";
    connection.dispatchEvent(new Event("state"));
    button.dispatchEvent(new Event("click"));
    return [button.textContent, button.attributes["aria-disabled"], done.splice(0)];
  };
  assert.deepEqual(press({ you: true, driver: "me" }), ["Enable", "false", ["enable"]]);
  assert.deepEqual(press({ you: true, driver: "me", phase: "ready" }), ["Enable", "true", []]);
  assert.deepEqual(press(WATCHING), ["Ask to drive", "false", ["ask_to_drive"]]);
  assert.deepEqual(press({ ...WATCHING, asking: "me" }), ["You have asked", "true", []]);
});

for (const [fields, why] of [
  [WATCHING, "driver_only"],
  [{ you: true }, "enable_first"],
  [{ you: true, at_start: true }, "at_start"],
  [{ you: true, phase: "ready" }, "help"],
  [{ you: true, phase: "moving" }, "let_go"],
  [{ you: true, phase: "ready", let_go_first: true }, "let_go"],
  [{ you: true, phase: "moving", returning: true }, "on"],
]) {
  test(`the way back: ${why}`, () => assert.equal(wayBackOf(connectionOf(fields)), why));
}
