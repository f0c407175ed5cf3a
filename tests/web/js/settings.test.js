import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { DEFAULTS, Settings } from "#pages/settings/settings.js";
import { newBrowser } from "./browser.js";

let fakes;
const keep = (name, values) => fakes.localStorage.setItem(`latentarm.settings.${name}`, typeof values === "string" ? values : JSON.stringify(values));

beforeEach(() => {
  fakes = newBrowser();
});

test("settings are those of the person who was here last", () => {
  const settings = new Settings();
  settings.become("Ada");
  settings.change({ sensitivity: 0.4 });
  assert.equal(new Settings().name, "Ada");
  assert.equal(new Settings().values.sensitivity, 0.4);
});

test("each person has their own, and somebody new has the defaults", () => {
  const settings = new Settings();
  settings.become("Ada");
  settings.change({ panel: "dpad" });
  settings.become(" Zoë Müller ");
  assert.equal(settings.name, "Zoë Müller");
  assert.deepEqual(settings.values, DEFAULTS);
  settings.change({ panel: "switch" });
  settings.become("Ada");
  assert.equal(settings.values.panel, "dpad");
  assert.deepEqual(settings.people.sort(), ["Ada", "Zoë Müller"]);
});

test("what is kept is taken only as far as it makes sense", () => {
  keep("", { sensitivity: 7, deadZone: -1, stepS: "long", panel: "joystick", press: "latch", shortcuts: 1, unknown: true });
  const { values } = new Settings();
  assert.equal(values.sensitivity, 1);
  assert.equal(values.deadZone, 0);
  assert.equal(values.stepS, DEFAULTS.stepS);
  assert.equal(values.panel, DEFAULTS.panel);
  assert.equal(values.press, "latch");
  assert.equal(values.shortcuts, DEFAULTS.shortcuts);
  assert.ok(!("unknown" in values));
});

for (const broken of ["", "{", "null", "[]", "7", '"text"']) {
  test(`what is kept may be broken (${broken || "empty"}): the defaults hold`, () => {
    keep("", broken);
    assert.deepEqual(new Settings().values, DEFAULTS);
  });
}

test("a browser that keeps nothing leaves settings that last as long as the page", () => {
  const refuse = () => {
    throw new Error("refused");
  };
  Object.defineProperty(globalThis, "localStorage", { get: refuse, configurable: true });
  const settings = new Settings();
  settings.change({ theme: "dark" });
  assert.equal(settings.values.theme, "dark");
  assert.deepEqual(settings.people, []);
});

test("the defaults can be had back", () => {
  const settings = new Settings();
  settings.change({ swapAxes: true, dwellS: 3 });
  settings.reset();
  assert.deepEqual(settings.values, DEFAULTS);
});
