/** Pointers that hold the stick, a button or a switch, and how each ends. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Deflection } from "#pages/inputs/deflection.js";
import { attachDpad } from "#pages/inputs/dpad.js";
import { attachHeldPointer } from "#pages/inputs/held_pointer.js";
import { Settings } from "#pages/settings/settings.js";
import { elementsOf, event, FakeElement, newBrowser } from "./browser.js";

let fakes;
let element;
let done;

const pointer = (type, fields) => event(type, { pointerId: 1, button: 0, buttons: 1, ...fields });
const at = (type, fields) => element.dispatchEvent(pointer(type, fields));
const moves = (fields) => fakes.window.dispatchEvent(pointer("pointermove", fields));

beforeEach(() => {
  fakes = newBrowser();
  element = Object.assign(new FakeElement(), { setPointerCapture: () => {} });
  done = [];
  const note = (what) => () => done.push(what);
  attachHeldPointer(element, {
    begins: () => done.push("begins") > 0, moves: note("moves"), ends: note("ends"), missed: note("missed"), lost: note("lost"),
  });
});

test("a pointer holds from its press until it comes up", () => {
  at("pointerdown");
  moves();
  at("pointerup", { buttons: 0 });
  at("lostpointercapture", { buttons: 0 });
  moves({ buttons: 0 });
  assert.deepEqual(done, ["begins", "moves", "ends"]);
});

test("a pointer that moves with no button down has let go", () => {
  at("pointerdown");
  moves({ buttons: 0 });
  moves();
  at("pointerup", { buttons: 0 });
  assert.deepEqual(done, ["begins", "missed"]);
});

test("another pointer neither moves nor ends it", () => {
  at("pointerdown");
  moves({ pointerId: 2, buttons: 0 });
  at("pointerdown", { pointerId: 2 });
  at("pointerup", { pointerId: 2, buttons: 0 });
  assert.deepEqual(done, ["begins"]);
});

for (const type of ["pointercancel", "lostpointercapture"]) {
  test(`${type} takes it away, once`, () => {
    at("pointerdown");
    at(type);
    at(type);
    assert.deepEqual(done, ["begins", "lost"]);
  });
}

test("a direction button lets go when its pointer moves with no button down", () => {
  const button = Object.assign(new FakeElement(), { dataset: { direction: "up" }, setPointerCapture: () => {} });
  const input = Object.assign(new Deflection(), { live: true });
  elementsOf({ group: "dpad", help: "dpad-help" }).group.querySelectorAll = () => [button];
  attachDpad(input, new Settings());
  button.dispatchEvent(pointer("pointerdown", { pointerType: "touch" }));
  assert.deepEqual([input.source, input.name], ["dpad", "touch"]);
  moves({ buttons: 0 });
  assert.equal(input.source, null);
});
