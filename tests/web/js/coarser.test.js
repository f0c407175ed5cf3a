import assert from "node:assert/strict";
import { test } from "node:test";

import { coarser } from "#pages/views/coarser.js";

/** A ball of so many rings of vertices. */
function ball(radius, rings) {
  const positions = [];
  const faces = [];
  for (let along = 0; along <= rings; along += 1) {
    for (let about = 0; about < rings; about += 1) {
      const [polar, turn] = [(Math.PI * along) / rings, (2 * Math.PI * about) / rings];
      positions.push(radius * Math.sin(polar) * Math.cos(turn), radius * Math.sin(polar) * Math.sin(turn), radius * Math.cos(polar));
      if (along === rings) continue;
      const [here, next] = [along * rings + about, along * rings + ((about + 1) % rings)];
      faces.push(here, here + rings, next, next, here + rings, next + rings);
    }
  }
  return [new Float32Array(positions), new Uint32Array(faces)];
}

test("a fine mesh loses most of its faces and keeps its shape", () => {
  const [positions, faces] = ball(0.08, 120);
  const fewer = coarser(positions, faces);
  assert.ok(fewer.faces.length < faces.length / 5, `${fewer.faces.length / 3} of ${faces.length / 3} faces`);
  for (let vertex = 0; vertex < fewer.positions.length; vertex += 3) {
    const away = Math.hypot(...fewer.positions.slice(vertex, vertex + 3));
    assert.ok(away > 0.07 && away <= 0.0801, `${away} m from the middle`);
  }
  assert.ok(Math.max(...fewer.faces) < fewer.positions.length / 3);
});

test("no face has lost its area, and a mesh that is coarse already stays as it is", () => {
  const [positions, faces] = ball(0.02, 90);
  const fewer = coarser(positions, faces);
  for (let face = 0; face < fewer.faces.length; face += 3) assert.equal(new Set(fewer.faces.slice(face, face + 3)).size, 3);
  const corners = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
  const sides = new Uint32Array([0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3]);
  const same = coarser(corners, sides);
  assert.deepEqual([same.positions, same.faces], [corners, sides]);
});
