/** Sounds and vibration: only what the person wants, and only when something happens. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachFeedback } from "#pages/feedback/feedback.js";
import { attachWakeLock } from "#pages/feedback/wake_lock.js";
import { newBrowser } from "./browser.js";

class FakeConnection extends EventTarget {
  engaged = false;

  driving = true;

  becomes(engaged) {
    this.engaged = engaged;
    this.dispatchEvent(new Event("state"));
  }
}

let tones, shakes, connection;

beforeEach(() => {
  newBrowser();
  tones = [];
  shakes = [];
  connection = new FakeConnection();
  const gain = { setValueAtTime() {}, linearRampToValueAtTime() {} };
  globalThis.AudioContext = class {
    currentTime = 0;
  };
  globalThis.OscillatorNode = class {
    constructor(_audio, { frequency }) {
      tones.push(frequency);
    }

    connect(next) {
      return next;
    }

    start() {}

    stop() {}
  };
  globalThis.GainNode = class {
    gain = gain;

    connect() {}
  };
  Object.defineProperty(globalThis.navigator, "vibrate", { value: (shake) => shakes.push(shake), configurable: true });
});

const feedback = (values) => attachFeedback(connection, { values: { sounds: "success", vibration: false, ...values } });

test("by default only success is heard, and nothing is felt", () => {
  const { tell } = feedback({});
  connection.becomes(true);
  connection.becomes(false);
  assert.deepEqual(tones, []);
  tell("success");
  assert.equal(tones.length, 3);
  assert.deepEqual(shakes, []);
});

test("Enable and Stop are heard once each where the person wants that, and Stop is felt", () => {
  feedback({ sounds: "all", vibration: true });
  connection.becomes(true);
  connection.becomes(true);
  assert.equal(tones.length, 1);
  connection.becomes(false);
  connection.becomes(false);
  assert.equal(tones.length, 3);
  assert.equal(shakes.length, 1);
});

test("silence is silence", () => {
  const { tell } = feedback({ sounds: "none" });
  tell("success");
  connection.becomes(true);
  assert.deepEqual(tones, []);
});

test("the screen stays on while this page drives an enabled arm, and no longer", async () => {
  const locks = [];
  const request = async () => {
    const lock = { held: true, release: () => { lock.held = false; } };
    locks.push(lock);
    return lock;
  };
  Object.defineProperty(globalThis.navigator, "wakeLock", { value: { request }, configurable: true });
  attachWakeLock(connection);
  connection.becomes(true);
  await Promise.resolve();
  assert.deepEqual(locks.map(({ held }) => held), [true]);
  connection.becomes(false);
  assert.deepEqual(locks.map(({ held }) => held), [false]);
  // A stop before the lock has been given.
  connection.becomes(true);
  connection.becomes(false);
  await Promise.resolve();
  await Promise.resolve();
  assert.deepEqual(locks.map(({ held }) => held), [false, false]);
  // Another page drives.
  connection.driving = false;
  connection.becomes(true);
  await Promise.resolve();
  assert.equal(locks.length, 2);
});
