import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachGripper, gripperWords } from "#pages/inputs/gripper.js";
import { elementsOf, event, newBrowser, pass, stateOf, welcomeOf } from "./browser.js";

const WIDE = 0.08;

let fakes;
let parts;
let connection;
let asked;
let refused;
let live;
/** What was asked to be opened as long as it is held. */
let held;
let gripper;

/** What the server says: whether there is a gripper, and how it is. */
function hears(state, widest = WIDE) {
  connection.welcome = welcomeOf({ gripper_width_m: widest });
  connection.dispatchEvent(new Event("welcome"));
  connection.state = stateOf({ gripper: state });
  connection.dispatchEvent(new Event("state"));
}

const at = (width_m, fields = {}) => ({ width_m, holding: false, closing: null, ...fields });

beforeEach(() => {
  fakes = newBrowser();
  parts = elementsOf({ panel: "gripper", open: "gripper-open", close: "gripper-close", state: "gripper-state", hold: "gripper-hold" });
  parts.panel.hidden = true;
  connection = Object.assign(new EventTarget(), { welcome: null, state: null });
  asked = [];
  refused = 0;
  live = true;
  held = null;
  const input = {
    ask: (what, source) => live && asked.push([what, source]) > 0,
    holdOpen: (source, still) => !live && connection.driving && (held = { source, still }) !== null,
  };
  gripper = attachGripper(connection, input, () => (refused += 1));
});

test("without a gripper nothing is shown, offered or asked", () => {
  hears(null, null);
  gripper.toggle("keyboard");
  assert.ok(parts.panel.hidden);
  assert.deepEqual(gripper.choices(), []);
  assert.deepEqual([asked, refused], [[], 0]);
});

test("buttons say what they ask, keys ask for the other way", () => {
  hears(at(WIDE));
  assert.ok(!parts.panel.hidden);
  parts.close.dispatchEvent(event("click"));
  parts.open.dispatchEvent(event("click"));
  gripper.toggle("gamepad");
  assert.deepEqual(asked, [["close", "pointer"], ["open", "pointer"], ["toggle", "gamepad"]]);
});

test("a second finger presses a button too, unless it slides off it; the first one clicks", () => {
  hears(at(WIDE));
  parts.close.contains = (element) => element === parts.close;
  const lift = (under, isPrimary) => {
    fakes.document.elementFromPoint = () => under;
    parts.close.dispatchEvent(event("pointerup", { isPrimary, clientX: 1, clientY: 1 }));
  };
  lift(parts.close, true);
  lift(parts.open, false);
  assert.deepEqual(asked, []);
  lift(parts.close, false);
  assert.deepEqual(asked, [["close", "pointer"]]);
});

test("the person hears why it does not move before the arm is enabled", () => {
  hears(at(WIDE));
  live = false;
  gripper.toggle("keyboard");
  assert.deepEqual([asked, refused], [[], 1]);
});

for (const [state, label, ask] of [
  [at(WIDE), "Close gripper", "close"],
  [at(0), "Open gripper", "open"],
  [at(0.06, { holding: true }), "Open gripper", "open"],
  [at(WIDE, { closing: true }), "Open gripper", "open"],
  [at(0, { closing: false }), "Close gripper", "close"],
]) {
  test(`a switch is offered what comes next: ${JSON.stringify(state)}`, () => {
    hears(state);
    const [choice, ...more] = gripper.choices();
    assert.deepEqual([choice.label, more], [label, []]);
    choice.act();
    assert.deepEqual(asked, [[ask, "switch"]]);
  });
}

for (const [state, words] of [
  [at(0.0799), "Open, 80 mm."],
  [at(0.05), "Partly open, 50 mm."],
  [at(0.0005), "Closed, 1 mm."],
  [at(0.0621, { holding: true }), "Holding something, 62 mm."],
  [null, "The robot does not know how far it is open."],
]) {
  test(`its state in words: ${words}`, () => assert.equal(gripperWords(state, WIDE), words));
}

test("the state is said when it has settled, and not at every millimetre", () => {
  const said = [];
  Object.defineProperty(parts.state, "textContent", { set: (text) => said.push(text), get: () => said.at(-1) ?? "" });
  for (let width = WIDE; width > 0.05; width -= 0.002) {
    hears(at(width));
    pass(20);
  }
  pass(300);
  assert.deepEqual(said, ["Partly open, 52 mm."]);
});

test("held while the arm is not enabled, the button, G and a gamepad's button open it until they are let go", () => {
  live = false;
  connection.driving = true;
  hears(at(0.02, { holding: true }));
  assert.ok(!parts.hold.hidden);
  const letGo = { pointer: "pointerup", keyboard: "keyup" };
  for (const source of ["pointer", "keyboard"]) {
    if (source === "pointer") parts.open.dispatchEvent(event("pointerdown"));
    else gripper.toggle(source);
    assert.equal(held.source, source);
    assert.ok(held.still());
    fakes.window.dispatchEvent(event(letGo[source]));
    assert.ok(!held.still());
  }
  let pads = [null, { connected: true, buttons: [{ pressed: true }] }];
  Object.defineProperty(globalThis.navigator, "getGamepads", { value: () => pads, configurable: true });
  gripper.toggle("gamepad");
  assert.ok(held.still());
  pads = [];
  assert.ok(!held.still());
  assert.deepEqual(asked, []);
});

test("the click that ends holding it asks nothing, and a short one says that the arm is not enabled", () => {
  live = false;
  connection.driving = true;
  hears(at(0.02));
  parts.open.dispatchEvent(event("pointerdown"));
  pass(1200);
  parts.open.dispatchEvent(event("click"));
  assert.equal(refused, 0);
  parts.open.dispatchEvent(event("pointerdown"));
  pass(200);
  parts.open.dispatchEvent(event("click"));
  assert.equal(refused, 1);
});
