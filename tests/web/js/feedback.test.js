/** Sounds and vibration: only what the person wants, and only when something happens. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachFeedback } from "#pages/feedback/feedback.js";
import { attachWakeLock } from "#pages/feedback/wake_lock.js";
import { newBrowser, pass } from "./browser.js";

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
  const tell = feedback({});
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
  const tell = feedback({ sounds: "none" });
  tell("success");
  connection.becomes(true);
  assert.deepEqual(tones, []);
});

const settled = () => new Promise((done) => { setImmediate(done); });

function fakeLocks(isRefused = () => false) {
  const locks = [];
  const request = async () => {
    const lock = { released: isRefused(), release: () => { lock.released = true; } };
    locks.push(lock);
    if (lock.released) throw new Error("refused");
    return lock;
  };
  Object.defineProperty(globalThis.navigator, "wakeLock", { value: { request }, configurable: true });
  attachWakeLock(connection);
  return locks;
}

test("the screen stays on while this page drives an enabled arm, and no longer", async () => {
  const locks = fakeLocks();
  const held = () => locks.map(({ released }) => !released);
  connection.becomes(true);
  await settled();
  assert.deepEqual(held(), [true]);
  connection.becomes(false);
  assert.deepEqual(held(), [false]);
  // A stop before the lock has been given.
  connection.becomes(true);
  connection.becomes(false);
  await settled();
  assert.deepEqual(held(), [false, false]);
  // Another page drives.
  connection.driving = false;
  connection.becomes(true);
  await settled();
  assert.equal(locks.length, 2);
});

test("a lock that the system takes back while the arm is enabled is taken again, on a page that can be seen", async () => {
  const locks = fakeLocks();
  connection.becomes(true);
  await settled();
  locks[0].release();
  globalThis.document.hidden = true;
  pass(5000);
  connection.becomes(true);
  await settled();
  assert.equal(locks.length, 1);
  globalThis.document.hidden = false;
  globalThis.document.dispatchEvent(new Event("visibilitychange"));
  await settled();
  assert.deepEqual(locks.map(({ released }) => released), [true, false]);
  locks[1].release();
  pass(1000);
  connection.becomes(true);
  await settled();
  assert.deepEqual(locks.map(({ released }) => released), [true, true, false]);
});

test("a lock that is refused is asked for again, once a second", async () => {
  const locks = fakeLocks(() => true);
  for (let passed = 0; passed < 3000; passed += 50) {
    connection.becomes(true);
    await settled();
    pass(50);
  }
  assert.equal(locks.length, 3);
});
