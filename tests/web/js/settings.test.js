import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { DEFAULTS, Settings } from "#pages/settings/settings.js";
import { newBrowser } from "./browser.js";

const ADA = { id: "00000000000000ad", name: "Ada" };
const ZOE = { id: "00000000000000ee", name: "Zoë Müller" };

let fakes;
const keep = (name, values) => fakes.localStorage.setItem(`latentarm.settings.${name}`, typeof values === "string" ? values : JSON.stringify(values));

beforeEach(() => {
  fakes = newBrowser();
});

test("settings are those of the person who was here last", () => {
  const settings = new Settings();
  settings.become(ADA);
  settings.change({ sensitivity: 0.4 });
  assert.equal(new Settings().name, "Ada");
  assert.equal(new Settings().values.sensitivity, 0.4);
});

test("each person has their own, and somebody new has the defaults", () => {
  const settings = new Settings();
  settings.byHand = true;
  settings.become(ADA);
  settings.change({ panel: "dpad" });
  settings.become(ZOE);
  assert.equal(settings.name, "Zoë Müller");
  assert.deepEqual(settings.values, DEFAULTS);
  settings.change({ panel: "switch" });
  settings.become(ADA);
  assert.equal(settings.values.panel, "dpad");
});

test("a switch that chooses somebody else stays, with its times and key, until they choose a control", () => {
  keep(ADA.id, { dwellS: 2, seat: "behind" });
  const settings = new Settings();
  settings.change({ panel: "switch", switchKey: "F8", dwellS: 3 });
  settings.become(ADA);
  const used = ({ panel, switchKey, dwellS, seat }) => [panel, switchKey, dwellS, seat];
  assert.deepEqual(used(settings.values), ["switch", "F8", 3, "behind"]);
  // So it is on the next page, and after a change of something else; the record stays Ada's own.
  settings.change({ tremor: "light" });
  settings.take({ dwellS: 2, seat: "behind" });
  const next = new Settings();
  assert.deepEqual(used(next.values), ["switch", "F8", 3, "behind"]);
  next.change({ dwellS: 4 });
  assert.equal(next.values.dwellS, 4);
  assert.deepEqual(used(next.own), ["stick", "Enter", 4, "behind"]);
  next.change({ panel: "stick" });
  assert.deepEqual(used(new Settings().values), ["stick", "Enter", 4, "behind"]);
});

test("a person whom a hand chooses has their own control at once", () => {
  const settings = new Settings();
  settings.change({ panel: "switch" });
  settings.byHand = true;
  settings.become(ADA);
  assert.equal(settings.values.panel, "stick");
});

test("somebody new drives slowly, the first of the speeds that the page has, and a speed that was chosen stays", () => {
  assert.equal(new Settings().values.sensitivity, 0.5);
  keep("", { sensitivity: 1 });
  assert.equal(new Settings().values.sensitivity, 1);
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

test("times of switches that a person chose stay, zeros too", () => {
  for (const [acceptS, releaseS] of [[0, 0.3], [0.5, 0], [0, 0]]) {
    keep("", { acceptS, releaseS });
    const { values } = new Settings();
    assert.deepEqual([values.acceptS, values.releaseS], [acceptS, releaseS]);
  }
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
});

test("the defaults can be had back", () => {
  const settings = new Settings();
  settings.change({ swapAxes: true, dwellS: 3 });
  settings.reset();
  assert.deepEqual(settings.values, DEFAULTS);
});

test("the defaults leave a switch user the switch, with its key and times", () => {
  const settings = new Settings();
  settings.change({ panel: "switch", switchKey: "F8", dwellS: 3, swapAxes: true });
  settings.reset();
  assert.deepEqual(settings.values, { ...DEFAULTS, panel: "switch", switchKey: "F8", dwellS: 3 });
});

test("settings of version 0.1.0 are found by the name, once", () => {
  keep("Ada", { panel: "dpad" });
  const settings = new Settings();
  settings.byHand = true;
  settings.become(ADA);
  assert.equal(settings.values.panel, "dpad");
  settings.change({ panel: "switch" });
  settings.become(null);
  assert.equal(settings.values.panel, DEFAULTS.panel);
  settings.become(ADA);
  assert.equal(settings.values.panel, "switch");
});

test("nothing of a person who is deleted stays in the browser", () => {
  keep("Zoë Müller", { panel: "dpad" });
  const settings = new Settings();
  settings.become(ZOE);
  settings.change({ dwellS: 2 });
  settings.forget(ZOE);
  assert.equal(settings.person, null);
  assert.deepEqual(settings.values, DEFAULTS);
  const left = JSON.stringify([...fakes.localStorage.kept]);
  assert.ok(!left.includes("Zo") && !left.includes(ZOE.id), left);
});

test("what the server keeps replaces what the browser has, and is not sent back", () => {
  const settings = new Settings();
  settings.become(ADA);
  let edited = 0;
  settings.addEventListener("edited", () => (edited += 1));
  settings.take({ panel: "dpad", sensitivity: 9, unknown: [1] });
  assert.equal(settings.values.panel, "dpad");
  assert.equal(settings.values.sensitivity, 1);
  assert.equal(edited, 0);
  settings.change({ panel: "stick" });
  assert.equal(edited, 1);
});

test("a person is called otherwise and stays the same", () => {
  const settings = new Settings();
  settings.become(ADA);
  settings.change({ panel: "dpad" });
  settings.rename("李雷");
  assert.deepEqual(new Settings().person, { ...ADA, name: "李雷" });
  assert.equal(new Settings().values.panel, "dpad");
});
