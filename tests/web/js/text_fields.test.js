/** Text that a field refuses, and languages that the pages do not have. */

import assert from "node:assert/strict";
import { test } from "node:test";

import { fits } from "../../../src/latentarm/web/pages/layout/too_long.js";
import { isForeign } from "../../../src/latentarm/web/pages/settings/language.js";

test("text fits that leaves a field within its length, whatever is selected", () => {
  const field = { value: "a".repeat(38), maxLength: 40, selectionStart: 38, selectionEnd: 38 };
  assert.ok(fits(field, "bc"));
  assert.ok(!fits(field, "bcd"));
  assert.ok(!fits({ ...field, value: "", selectionStart: 0, selectionEnd: 0 }, "b".repeat(200)));
  assert.ok(fits({ ...field, selectionStart: 0 }, "b".repeat(40)));
  assert.ok(fits({ ...field, maxLength: -1 }, "b".repeat(200)));
});

test("a browser is told once that its language is missing, and only if all of its languages are", () => {
  const known = ["de", "en", "es", "zh"];
  assert.ok(isForeign(["fr-FR", "fr"], known));
  assert.ok(!isForeign(["fr-FR", "fr", "en-US"], known));
  assert.ok(!isForeign(["de-AT"], known));
  assert.ok(!isForeign([], known));
});
