import assert from "node:assert/strict";
import { test } from "node:test";

import { PixelShare } from "#pages/views/pixel_share.js";

test("frames that are held up cost pixels, those in time give them back, and each relapse makes that slower", () => {
  const pixels = new PixelShare();
  const untilLess = () => {
    let frames = 1;
    while (!pixels.held(8)) frames += 1;
    return frames;
  };
  const untilMore = () => {
    let frames = 1;
    while (!pixels.inTime()) frames += 1;
    return frames;
  };
  untilLess();
  assert.ok(pixels.share < 1);
  const first = untilMore();
  assert.equal(pixels.share, 1);
  untilLess();
  assert.ok(untilMore() > 1.5 * first);
  for (let frame = 0; frame < 10000; frame += 1) pixels.held(8);
  assert.equal(pixels.share, 0.5);
});
