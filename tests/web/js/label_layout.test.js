import assert from "node:assert/strict";
import { test } from "node:test";

import { ROW_PX, crosses, layOutNames, overlap } from "#pages/views/label_layout.js";

/** Numbers that look random, and are the same in every run. @param {number} seed */
function randomFrom(seed) {
  let state = seed;
  return (low = 0, high = 1) => {
    state = (state * 1664525 + 1013904223) % 4294967296;
    return low + ((high - low) * state) / 4294967296;
  };
}

/** A tool with four arrows and things anywhere in a view of any size. @param {number} seed */
function scene(seed) {
  const random = randomFrom(seed);
  const view = { width: random(120, 900), height: random(90, 600) };
  const about = (x, y, half) => ({ left: x - half, top: y - half, right: x + half, bottom: y + half });
  const tool = [random(0, view.width), random(0, view.height)];
  const arrows = Array.from({ length: 4 }, () => about(tool[0] + random(-90, 90), tool[1] + random(-90, 90), 11));
  const names = Array.from({ length: 1 + Math.floor(random(0, 8)) }, () => {
    const wide = random(40, 260);
    return { x: random(-50, view.width + 50), y: random(-50, view.height + 50), wide, narrow: Math.min(wide, random(20, 60)), before: null };
  });
  const kept = [about(...tool, 14), ...arrows, ...names.map(({ x, y }) => about(x, y, 14))];
  return { view, names, kept };
}

const boxOf = ({ left, top, cut }, { wide, narrow }) => ({ left, top, right: left + (cut ? narrow : wide), bottom: top + ROW_PX - 2 });

test("no name covers tool, things, arrows or another name, none is cut off, and no line crosses any of them", () => {
  for (let seed = 1; seed <= 2000; seed += 1) {
    const { view, names, kept } = scene(seed);
    const places = layOutNames(names, kept, [], view);
    const boxes = places.flatMap((place, index) => (place ? [boxOf(place, names[index])] : []));
    for (const [index, box] of boxes.entries()) {
      assert.ok(box.left >= 0 && box.top >= 0 && box.right <= view.width && box.bottom <= view.height, `seed ${seed}`);
      for (const other of [...kept, ...boxes.slice(index + 1)]) assert.ok(!overlap(box, other), `seed ${seed}`);
    }
    places.forEach((place, index) => {
      if (!place?.leader) return;
      const to = names[index];
      const others = kept.filter(({ left, top, right, bottom }) => !(left <= to.x && to.x <= right && top <= to.y && to.y <= bottom));
      for (const other of others) assert.ok(!crosses(place.leader, to, other), `seed ${seed}`);
    });
  }
});

test("in a view as on a laptop every name is shown whole, wherever the tool is", () => {
  for (let seed = 1; seed <= 500; seed += 1) {
    const { names, kept } = scene(seed);
    const places = layOutNames(names.slice(0, 5), kept, [], { width: 670, height: 540 });
    assert.ok(places.every((place) => place && !place.cut), `seed ${seed}`);
  }
});

test("a name does not jump while its thing moves a little", () => {
  for (let seed = 1; seed <= 500; seed += 1) {
    const { view, names } = scene(seed);
    const kept = names.map(({ x, y }) => ({ left: x - 14, top: y - 14, right: x + 14, bottom: y + 14 }));
    const [first] = layOutNames([names[0]], kept, [], view);
    if (!first) continue;
    const moved = { ...names[0], x: names[0].x + 8, y: names[0].y - 8, before: first };
    const [then] = layOutNames([moved], kept, [], view);
    assert.deepEqual([then.left, then.top], [first.left, first.top], `seed ${seed}`);
  }
});
