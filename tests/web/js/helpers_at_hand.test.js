/** Help from the robot, a co-pilot, and the end of a motion that nobody holds. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Connection } from "#pages/connection/connection.js";
import { copilotWords } from "#pages/connection/copilot.js";
import { attachHelp, helpWords } from "#pages/drive/help.js";
import { Deflection } from "#pages/inputs/deflection.js";
import { attachLatchLimit } from "#pages/inputs/latch_limit.js";
import { Settings } from "#pages/settings/settings.js";
import { elementsOf, FakeSocket, newBrowser, pass, stateOf, welcomeOf } from "./browser.js";

let settings;
let connection;
let socket;

beforeEach(() => {
  newBrowser();
  settings = new Settings();
  connection = new Connection("");
  socket = FakeSocket.newest;
  socket.opens();
  socket.says(welcomeOf());
  socket.taken();
});

function attached() {
  const { fieldset } = elementsOf({ fieldset: "help", text: "help-text" });
  fieldset.querySelectorAll = () => [];
  return attachHelp(connection, settings);
}

const asked = () => socket.taken().filter(({ type }) => type === "help").map(({ level }) => level);

test("the person's level of help is asked for once when they drive, and when they choose another one", () => {
  settings.change({ help: "high" });
  attached();
  socket.says(stateOf({ you: false, help: "medium" }));
  assert.deepEqual(asked(), []);
  for (let times = 0; times < 3; times += 1) socket.says(stateOf({ you: true, help: "medium" }));
  assert.deepEqual(asked(), ["high"]);
  socket.says(stateOf({ you: true, help: "high" }));
  settings.change({ help: "off" });
  assert.deepEqual(asked(), ["off"]);
});

test("where the robot cannot help there is nothing to choose", () => {
  attached();
  socket.says(stateOf({ you: true, help: null }));
  assert.deepEqual(asked(), []);
  assert.equal(helpWords({ mode: "latent", help: null }), "");
});

test("what a level does is said in words, and that it does nothing with straight lines", () => {
  const said = ["off", "low", "medium", "high"].map((help) => helpWords({ mode: "latent", help }));
  assert.equal(new Set(said).size, 4);
  assert.match(helpWords({ mode: "end_effector", help: "high" }), /does not help/);
});

test("everybody is told who the co-pilot is, and what they leave of the speed", () => {
  const bob = { id: "bob", name: "Bob" };
  const words = (fields, me) => copilotWords(stateOf({ driver: "ada", ...fields }), me);
  assert.match(words({ you: true, copilot_asking: bob }, "ada"), /^Bob asks .* never make it faster/);
  assert.match(words({ you: true, copilot: { ...bob, pace: 0.4 } }, "ada"), /Bob is your co-pilot: 40 %/);
  assert.match(words({ copilot: { ...bob, pace: 0.4 } }, "eve"), /Bob is co-pilot: 40 %/);
  assert.match(words({ copilot: { ...bob, pace: 1 } }, "bob"), /^You are the co-pilot/);
  assert.match(words({ copilot_asking: bob }, "bob"), /^You have asked/);
});

for (const [latchS, most, ends] of [[3, 10, 3000], [10, 5, 5000]]) {
  test(`a latched motion ends after ${latchS} s, or the server's ${most} s where that is shorter`, () => {
    socket.says(welcomeOf({ latch_max_s: most }));
    settings.change({ latchS });
    const input = new Deflection();
    attachLatchLimit(input, connection, settings);
    input.hold("switch", 1, 0, true);
    pass(ends - 1);
    assert.equal(input.source, "switch");
    pass(1);
    assert.equal(input.source, null);
  });
}

test("a push that does not change ends before the server would stop the arm, which is said 3 s before", () => {
  settings.change({ latchS: 2 });
  const input = new Deflection();
  const said = [];
  attachLatchLimit(input, connection, settings, (ends) => said.push(ends));
  for (const source of ["keyboard", "dpad", "pointer", "gamepad"]) {
    // As a gamepad, which is read again and again.
    for (let passed = 0; passed < 4750; passed += 10) {
      input.hold(source, 0.7, 0);
      assert.equal(input.source, source);
      pass(10);
      if (passed === 1700) assert.ok(!said.includes(true));
      if (passed === 1800) assert.equal(said.at(-1), true);
    }
    assert.equal(input.source, null);
    assert.equal(said.at(-1), true);
    input.neutral();
    assert.equal(said.at(-1), false);
    said.length = 0;
  }
});

test("a push that changes goes on", () => {
  const input = new Deflection();
  attachLatchLimit(input, connection, settings);
  for (let times = 0; times < 6; times += 1) {
    input.hold("gamepad", 0.7 + 1e-6 * times, 0);
    pass(4000);
  }
  assert.equal(input.source, "gamepad");
});

test("a motion that was let go does not end the next", () => {
  settings.change({ latchS: 2 });
  const input = new Deflection();
  attachLatchLimit(input, connection, settings);
  input.hold("switch", 1, 0, true);
  pass(1500);
  input.release("switch");
  input.hold("switch", 1, 0, true);
  pass(1500);
  assert.equal(input.source, "switch");
});
