/** A motion that goes on by itself ends where its way ends, and only there. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Deflection } from "#pages/inputs/deflection.js";
import { attachWayEnd } from "#pages/drive/way_end.js";
import { newBrowser, pass } from "./browser.js";

/** How the arm moves along a straight line, Slow, m/s and m/s²; it comes to rest within that far, m. */
const [FASTEST, FASTER, COASTS] = [0.075, 0.5, 0.0012];
/** A place is this old when the page hears of it, and the page is heard so late, ms. */
const [OLD_MS, LATE_MS] = [20, 20];
const HEARS_MS = 20;

let input;
let connection;
let far;
let on;

beforeEach(() => {
  newBrowser();
  input = new Deflection();
  connection = new EventTarget();
  on = true;
  attachWayEnd(input, connection, () => far, () => on);
});

/** Drive for 3 s, or until the arm is at rest, and return how far is left. @param {number} way m @param {(at: number) => number} [waver] of the messages, ms */
function drive(way, waver = () => 0) {
  const places = [way];
  let [speed, letGo, next] = [0, 0, 0];
  for (let at = 0; at < 3000 && letGo <= LATE_MS; at += 1) {
    pass(1);
    speed = Math.min(speed + FASTER / 1000, FASTEST);
    places.push(places.at(-1) - speed / 1000);
    if (input.source === null) letGo += 1;
    if (at < next) continue;
    next = at + HEARS_MS + waver(at);
    far = places[Math.max(at - OLD_MS, 0)];
    connection.dispatchEvent(new Event("state"));
  }
  return places.at(-1) - COASTS;
}

for (const way of [0.004, 0.01, 0.03, 0.12]) {
  test(`a latched push ends within 4 mm of its end: ${way} m`, () => {
    input.hold("switch", 0, 1, true);
    const left = drive(way, (at) => (at % 3 === 0 ? 15 : 0));
    assert.equal(input.source, null);
    assert.ok(Math.abs(left) < 0.004, `${left}`);
  });
}

test("a push that is held, one by something else, one beyond the end or away from it, and one of a person who wants none of this go on", () => {
  for (const [way, latched, wants, source = "switch"] of [[0.05, false, true], [-0.001, true, true], [0.05, true, false], [0.05, true, true, "keyboard"]]) {
    on = wants;
    input.hold(source, 0, 1, latched);
    drive(way);
    assert.equal(input.source, source);
    input.neutral();
  }
});

test("a push in another direction is judged by itself", () => {
  far = 0.01;
  input.hold("switch", 0, 1, true);
  connection.dispatchEvent(new Event("state"));
  input.hold("switch", 1, 0, true);
  far = 0.2;
  pass(HEARS_MS);
  connection.dispatchEvent(new Event("state"));
  pass(HEARS_MS);
  far = 0.199;
  connection.dispatchEvent(new Event("state"));
  assert.equal(input.source, "switch");
});
