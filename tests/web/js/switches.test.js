/** Switches as hands need them: how long a press must be, what repeats, and the ways to scan. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Deflection } from "#pages/inputs/deflection.js";
import { attachChatterGuard } from "#pages/inputs/chatter.js";
import { isSwitch } from "#pages/inputs/keys.js";
import { groupOf } from "#pages/inputs/scanning.js";
import { Scanner } from "#pages/inputs/scanner.js";
import { attachSpeech } from "#pages/inputs/speech.js";
import { DEFAULTS, Settings } from "#pages/settings/settings.js";
import { newBrowser, pass } from "./browser.js";

/** What counts without anybody having set anything. */
const REAL = { acceptS: DEFAULTS.acceptS, releaseS: DEFAULTS.releaseS };

let fakes;
let input;
let settings;
let scanner;
let done;

const choices = (...ids) => ids.map((id) => ({ id, label: id, act: () => done.push(id) }));
const lit = () => scanner.choices[scanner.lit].id;
const down = (number = 0) => scanner.press(number, true);
const up = (number = 0) => scanner.press(number, false);

/** Press for so long, ms. */
function press(ms, number = 0) {
  down(number);
  pass(ms);
  up(number);
}

function set(values) {
  settings.change(values);
}

beforeEach(() => {
  fakes = newBrowser();
  input = Object.assign(new Deflection(), { halt: () => input.neutral() });
  settings = new Settings();
  set({ panel: "switch", dwellS: 1, acceptS: 0, releaseS: 0 });
  done = [];
  scanner = new Scanner(input, settings);
  scanner.offer(choices("first", "second", "up", "stop"));
});

test("a press counts only if it is held for the acceptance time", () => {
  set({ acceptS: 0.3 });
  press(290);
  assert.deepEqual(done, []);
  pass(20);
  down();
  pass(299);
  assert.deepEqual(done, []);
  pass(1);
  assert.deepEqual(done, ["first"]);
  up();
  pass(50);
  assert.deepEqual(done, ["first"]);
});

test("nothing counts until the switch has been left alone for the release time", () => {
  set({ releaseS: 0.5, dwellS: 5 });
  press(20);
  for (let again = 0; again < 6; again += 1) {
    pass(490);
    press(20);
  }
  assert.deepEqual(done, ["first"]);
  pass(500);
  press(20);
  assert.deepEqual(done, ["first", "first"]);
});

test("contacts that bounce, as a press begins and as it ends, make one press of it", () => {
  scanner.offer(choices("up", "stop"));
  pass(200);
  set({ ...REAL, dwellS: 5 });
  for (const ms of [2, 3, 1]) {
    press(ms);
    pass(1);
  }
  press(80);
  pass(3);
  press(2);
  assert.equal(scanner.moving, "up");
});

for (const [what, downMs, upMs] of [
  ["chatters at 20 Hz", 25, 25], ["chatters at 20 Hz, mostly closed", 45, 5], ["presses every 150 ms", 75, 75],
  ["presses every 150 ms, shortly", 20, 130], ["presses every 150 ms, mostly closed", 145, 5],
]) {
  for (const times of [7, 8, 100]) {
    test(`a switch that ${what}, ${times} times, leaves nothing moving`, () => {
      attachChatterGuard(input);
      set(REAL);
      scanner.offer(choices("up", "down", "left", "right"));
      pass(1000);
      let movedMs = 0;
      const go = (ms) => {
        for (let passed = 0; passed < ms; passed += 1, pass(1)) movedMs += input.source === null ? 0 : 1;
      };
      for (let time = 0; time < times; time += 1) {
        down();
        go(downMs);
        up();
        go(upMs);
      }
      assert.equal(input.source, null);
      assert.ok(movedMs <= 300, `${movedMs} ms`);
    });
  }
}

for (const hertz of [10, 15, 20, 25, 30]) {
  for (const share of [0.2, 0.5, 0.9]) {
    test(`an adapter that repeats at ${hertz} Hz while it is held, down for ${share} of the time, presses once`, () => {
      set({ ...REAL, dwellS: 9 });
      for (const seconds of [0.4, 1, 3]) {
        pass(500);
        const period = Math.round(1000 / hertz);
        for (let time = 0; time < seconds * hertz; time += 1) {
          press(Math.round(share * period));
          pass(period - Math.round(share * period));
        }
      }
      assert.deepEqual(done, ["first", "first", "first"]);
    });
  }
}

test("a hand that trembles at 8 Hz on a switch presses nothing that asks for a longer press", () => {
  set({ ...REAL, acceptS: 0.3 });
  for (let time = 0; time < 40; time += 1) {
    press(70);
    pass(55);
  }
  assert.deepEqual(done, []);
});

test("quick presses of a person count: 80 ms long, three in a second", () => {
  set({ ...REAL, switches: "2" });
  for (let times = 0; times < 6; times += 1) {
    press(80, 1);
    pass(250);
  }
  assert.equal(lit(), "up");
});

test("a press that ends a motion counts at once, however soon after the last, and says that the switch chatters", () => {
  const halted = [];
  input.halt = (why) => halted.push(why);
  attachChatterGuard(input);
  scanner.offer(choices("up", "stop"));
  pass(500);
  set(REAL);
  press(80);
  assert.equal(scanner.moving, "up");
  pass(15);
  down();
  assert.equal(scanner.moving, null);
  assert.deepEqual(halted, ["switch_chatters"]);
  up();
  pass(400);
  press(80);
  pass(400);
  press(80);
  assert.equal(scanner.moving, null);
  assert.deepEqual(halted, ["switch_chatters"]);
});

test("what has been lit for less time than it takes to see it is not chosen, and a little later it is", () => {
  scanner.offer(choices("up", "down", "left"));
  for (const [seenMs, moves] of [[170, null], [230, "down"]]) {
    pass(1000 + seenMs);
    assert.equal(lit(), "down");
    press(20);
    assert.equal(scanner.moving, moves);
    scanner.offer(choices("other"));
    scanner.offer(choices("up", "down", "left"));
  }
});

test("inverse: letting go sooner than what is lit can have been seen chooses nothing", () => {
  set({ scan: "inverse" });
  scanner.offer(choices("up", "down", "left"));
  for (const [seenMs, moves] of [[170, null], [230, "down"]]) {
    pass(300);
    press(1000 + seenMs);
    assert.equal(scanner.moving, moves);
    scanner.offer(choices("other"));
    scanner.offer(choices("up", "down", "left"));
  }
});

test("a list that another one replaces is not chosen from before it can have been seen", () => {
  set({ switches: "2" });
  scanner.offer(choices("enable", "mode"));
  pass(150);
  press(20);
  assert.deepEqual(done, []);
  pass(100);
  press(20);
  assert.deepEqual(done, ["enable"]);
});

test("Stop counts where it was lit a moment ago, and where it is lit since a moment ago", () => {
  for (const ids of [["stop", "up"], ["up", "stop"]]) {
    scanner.offer(choices(...ids));
    pass(1100);
    press(20);
    scanner.offer(choices("other"));
    pass(300);
  }
  assert.deepEqual(done, ["stop", "stop"]);
});

test("a press that began in the release time does not count later", () => {
  set({ releaseS: 0.5, dwellS: 5 });
  press(20);
  pass(100);
  press(2000);
  assert.deepEqual(done, ["first"]);
});

test("a motion ends at once with a press, however long a press must be to choose", () => {
  set({ acceptS: 0.5, dwellS: 1 });
  scanner.offer(choices("up", "stop"));
  pass(300);
  press(500);
  assert.equal(scanner.moving, "up");
  pass(300);
  down();
  assert.equal(scanner.moving, null);
  assert.equal(input.source, null);
  pass(600);
  up();
  assert.equal(scanner.moving, null);
});

test("holding the second switch moves the light on every repeat time, and without one only once", () => {
  set({ switches: "2" });
  press(3000, 1);
  assert.equal(lit(), "second");
  set({ repeatS: 0.4 });
  pass(20);
  press(850, 1);
  assert.equal(lit(), "first");
  pass(5000);
  assert.equal(lit(), "first");
});

test("inverse: the light moves while the switch is held, and letting go chooses", () => {
  set({ scan: "inverse" });
  pass(5000);
  assert.equal(lit(), "first");
  down();
  pass(1500);
  assert.equal(lit(), "second");
  assert.deepEqual(done, []);
  up();
  assert.deepEqual(done, ["second"]);
  pass(5000);
  assert.deepEqual(done, ["second"]);
});

test("inverse: a press that is too short begins nothing, and one that is taken away chooses nothing", () => {
  set({ scan: "inverse", acceptS: 0.3 });
  press(200);
  pass(2000);
  assert.deepEqual(done, []);
  down();
  pass(800);
  fakes.window.dispatchEvent(new Event("blur"));
  up();
  assert.deepEqual(done, []);
});

test("step: each press moves the light, and waiting chooses", () => {
  set({ scan: "step" });
  pass(5000);
  assert.deepEqual(done, []);
  press(100);
  assert.equal(lit(), "first");
  pass(20);
  press(100);
  assert.equal(lit(), "second");
  pass(890);
  assert.deepEqual(done, []);
  pass(100);
  assert.deepEqual(done, ["second"]);
  pass(5000);
  assert.deepEqual(done, ["second"]);
});

test("step: holding moves the light on every repeat time", () => {
  set({ scan: "step", repeatS: 0.3 });
  press(700);
  assert.equal(lit(), "up");
});

test("hold to move: with automatic scanning the arm moves while the switch is held", () => {
  set({ switchMotion: "hold" });
  pass(2300);
  down();
  assert.deepEqual([scanner.moving, input.latched], ["up", false]);
  pass(4000);
  assert.equal(scanner.moving, "up");
  up();
  assert.equal(input.source, null);
});

for (const scan of ["inverse", "step"]) {
  test(`hold to move: with ${scan} scanning a direction waits to be held, moves meanwhile, and is forgotten`, () => {
    set({ switchMotion: "hold", scan });
    scanner.offer(choices("up", "stop"));
    pass(300);
    press(500);
    if (scan === "step") pass(1000);
    assert.deepEqual([scanner.ready, scanner.moving], ["up", null]);
    assert.equal(input.source, null);
    pass(20);
    down();
    assert.deepEqual([scanner.moving, input.latched], ["up", false]);
    pass(3000);
    up();
    assert.deepEqual([scanner.ready, scanner.moving, input.source], [null, null, null]);
    pass(20);
    press(500);
    if (scan === "step") pass(1000);
    pass(7000);
    assert.equal(scanner.ready, null);
  });
}

test("hold to move: a click without anything held latches, and what latches ends by itself", () => {
  set({ switchMotion: "hold" });
  scanner.offer(choices("up"));
  scanner.choose();
  assert.equal(input.latched, true);
});

test("a switch that is taken away ends what was held, and not what goes on by itself", () => {
  set({ switchMotion: "hold" });
  scanner.offer(choices("up"));
  pass(300);
  down();
  scanner.lost();
  assert.equal(input.source, null);
  set({ switchMotion: "latch" });
  press(50);
  scanner.lost();
  assert.equal(scanner.moving, "up");
});

test("the first choice stays lit for longer", () => {
  set({ firstS: 2 });
  pass(2990);
  assert.equal(lit(), "first");
  pass(20);
  assert.equal(lit(), "second");
  pass(1000);
  assert.equal(lit(), "up");
});

test("a group opens, Back leads out by one level, and a choice leads back to the first list", () => {
  const stop = choices("stop")[0];
  const inner = groupOf("inner", "Inner", () => choices("deep"), [stop]);
  scanner.offer([groupOf("outer", "Outer", () => [...choices("one"), inner], [stop]), ...choices("other")]);
  scanner.choose();
  assert.deepEqual(scanner.choices.map(({ id }) => id), ["one", "inner", "stop", "outer-back"]);
  scanner.next();
  scanner.choose();
  assert.deepEqual(scanner.choices.map(({ id }) => id), ["deep", "stop", "inner-back"]);
  scanner.next();
  scanner.next();
  scanner.choose();
  assert.equal(lit(), "one");
  scanner.choose();
  assert.deepEqual(done, ["one"]);
  assert.equal(lit(), "outer");
});

test("a group that is not offered any more closes", () => {
  scanner.offer([groupOf("outer", "Outer", () => choices("one"))]);
  scanner.choose();
  scanner.offer(choices("enable", "mode"));
  assert.equal(lit(), "enable");
});

test("a small change leaves the light where it is", () => {
  scanner.offer([groupOf("outer", "Outer", () => choices("less", "more").map((one) => ({ ...one, stays: true })))]);
  scanner.choose();
  scanner.choose();
  scanner.choose();
  assert.deepEqual(done, ["less", "less"]);
  assert.equal(lit(), "less");
});

test("Space is a switch only where it was chosen as one, and while switches are used", () => {
  assert.ok(!isSwitch(settings.values, "Space"));
  set({ switchKey: "Space" });
  assert.ok(isSwitch(settings.values, "Space"));
  set({ panel: "stick" });
  assert.ok(!isSwitch(settings.values, "Space"));
  set({ panel: "switch", switchKey: "Enter", nextKey: "Space" });
  assert.ok(!isSwitch(settings.values, "Space"));
  set({ switches: "2" });
  assert.ok(isSwitch(settings.values, "Space"));
});

test("what is lit is spoken once, in the language of the page and as loud as was chosen, in place of the last", () => {
  const said = [];
  const speechSynthesis = { cancel: () => said.push("cancel"), speak: (one) => said.push([one.text, one.lang, one.volume]) };
  class SpeechSynthesisUtterance {
    constructor(text) {
      this.text = text;
    }
  }
  fakes.window.speechSynthesis = speechSynthesis;
  Object.assign(globalThis, { speechSynthesis, SpeechSynthesisUtterance });
  fakes.document.documentElement = { lang: "de" };
  const speak = attachSpeech(settings, "speak");
  speak("Hoch");
  assert.deepEqual(said, []);
  set({ speak: true, speakVolume: 0.3 });
  speak("Hoch");
  speak("Hoch");
  speak("Links");
  assert.deepEqual(said, ["cancel", ["Hoch", "de", 0.3], "cancel", ["Links", "de", 0.3]]);

  // What is to be done is spoken once it has stayed for a second, and cuts nothing off.
  const tell = attachSpeech(settings, "speakNext", 1000);
  said.length = 0;
  tell("Push Left");
  set({ speakNext: true });
  for (const text of ["Push Right 16 cm", "", "Push Right 12 cm", "Push Right 11 cm"]) {
    tell(text);
    pass(900);
  }
  assert.deepEqual(said, []);
  tell("Push Right 11 cm");
  pass(200);
  tell("Push Right 11 cm");
  pass(2000);
  assert.deepEqual(said, [["Push Right 11 cm", "de", 0.3]]);
});
