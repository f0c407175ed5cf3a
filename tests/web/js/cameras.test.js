import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { CameraView, OLDEST_MS } from "#pages/cameras/camera_view.js";
import { ServerClock, takenAt } from "#pages/cameras/picture_age.js";
import { FakeElement, newBrowser } from "./browser.js";

beforeEach(() => {
  newBrowser();
});

/** A camera whose clock is 1000 ms ahead of the page's. */
function newView() {
  const clock = new ServerClock();
  clock.answered(0, 10, 1005);
  const parts = { video: new FakeElement(), ".picture-age": new FakeElement(), ".camera-says": new FakeElement() };
  const waiting = [];
  parts.video.requestVideoFrameCallback = (call) => waiting.push(call);
  const figure = { dataset: {}, querySelector: (selector) => parts[selector] };
  const view = new CameraView(figure, clock);
  return {
    view,
    /** A picture with this timestamp is shown now. */
    shows: (rtpTimestamp) => waiting.shift()(0, { rtpTimestamp }),
    look: (now, connected = true) => view.look(now, connected),
    get old() { return figure.dataset.old === "true"; },
    get said() { return parts[".camera-says"].textContent; },
    get age() { return parts[".picture-age"].textContent; },
  };
}

test("the quickest answer says what time it is at the server", () => {
  const clock = new ServerClock();
  assert.equal(clock.aheadMs, null);
  clock.answered(0, 400, 5390);
  clock.answered(1000, 1010, 6005);
  clock.answered(2000, 2300, 7290);
  assert.equal(clock.aheadMs, 5000);
  clock.answered(10, 9, 0);
  assert.equal(clock.aheadMs, 5000);
});

test("answers of long ago count no more", () => {
  const clock = new ServerClock();
  clock.answered(0, 1, 100);
  for (let number = 0; number < 20; number += 1) clock.answered(0, 10, 905);
  assert.equal(clock.aheadMs, 900);
});

test("a timestamp that has wrapped around means the moment after", () => {
  assert.equal(takenAt({ rtp: 0xffffffff, at: 1000 }, 89), 1001);
  assert.equal(takenAt({ rtp: 89, at: 1001 }, 0xffffffff), 1000);
  assert.equal(takenAt({ rtp: 5, at: 7 }, 5), 7);
});

test("a picture is grey when it is too old, also where no other one follows", () => {
  const camera = newView();
  camera.view.state = "live";
  camera.view.dated = { rtp: 0, at: 2000 };
  camera.look(1000);
  camera.shows(0);
  camera.look(1080);
  assert.ok(camera.old, "what was not seen for half a second is not yet clear");
  for (let now = 1100; now <= 1700; now += 50) {
    camera.shows((now - 1000 - 80) * 90);
    camera.look(now);
  }
  assert.ok(!camera.old);
  assert.equal(camera.age, "80 ms");
  assert.equal(camera.said, "");
  camera.look(1620 + OLDEST_MS);
  assert.ok(!camera.old);
  camera.look(1621 + OLDEST_MS);
  assert.ok(camera.old);
  assert.match(camera.said, /This picture is old/);
});

test("what is the matter is said in words, the worst first", () => {
  const camera = newView();
  camera.look(1000, false);
  assert.match(camera.said, /on its way/);
  camera.view.state = "lost";
  camera.look(1000);
  assert.match(camera.said, /No picture from this camera/);
  camera.view.state = "dark";
  camera.view.dated = { rtp: 0, at: 2000 };
  for (let now = 1000; now <= 1600; now += 50) {
    camera.shows((now - 1000) * 90);
    camera.look(now);
  }
  assert.match(camera.said, /too dark/);
  assert.ok(!camera.old);
});

test("a browser that does not say which picture it shows is not believed", () => {
  const camera = newView();
  camera.view.state = "live";
  camera.view.dated = { rtp: 0, at: 2000 };
  camera.shows(undefined);
  camera.look(1000);
  camera.look(2000);
  assert.ok(camera.old);
  assert.match(camera.said, /cannot tell how old/);
});

test("another connection begins without what was known of the one before", () => {
  const camera = newView();
  camera.view.dated = { rtp: 0, at: 2000 };
  camera.shows(0);
  assert.equal(camera.view.ageMs(1010), 10);
  camera.view.show(null);
  assert.equal(camera.view.ageMs(1010), null);
});
