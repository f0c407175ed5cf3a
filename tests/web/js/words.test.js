import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { beforeEach, test } from "node:test";

import { say, sayNotice, sayNumber, sayPercent, useWords } from "#pages/layout/words.js";
import { newBrowser } from "./browser.js";

const PAGES = new URL("../../../src/latentarm/web/pages/", import.meta.url);

beforeEach(newBrowser);

test("parameters go where the sentence has them", () => {
  useWords("en", { greeting: "{name}, meet {other}; {name}!" });
  assert.equal(say("greeting", { name: "Ada", other: "Bea" }), "Ada, meet Bea; Ada!");
});

test("a parameter's own braces are not parameters", () => {
  useWords("en", { greeting: "{name}: {other}" });
  assert.equal(say("greeting", { name: "{other}", other: "B" }), "{other}: B");
});

test("a notice names guests and the notice that caused it in the page's language", () => {
  useWords("de", {
    "driver.guest": "Gast {number}", "notice.stop_pressed_by": "{name} hat Stopp gedrückt.",
    "notice.recording_ended": "Ende. {because}", "notice.joint_jumped": "{joint} sprang um {moved_deg}°.",
  });
  assert.equal(sayNotice({ code: "stop_pressed_by", parameters: { name: 3 } }), "Gast 3 hat Stopp gedrückt.");
  assert.equal(sayNotice({ code: "stop_pressed_by", parameters: { name: "Ada" } }), "Ada hat Stopp gedrückt.");
  const cause = { because: "joint_jumped", joint: "joint3", moved_deg: 17 };
  assert.equal(sayNotice({ code: "recording_ended", parameters: cause }), "Ende. joint3 sprang um 17°.");
});

test("plural forms are the language's", () => {
  const plant = { one: "{count} kos", two: "{count} kosa", few: "{count} kosi", other: "{count} kosov" };
  useWords("sl", { pieces: plant });
  assert.deepEqual([1, 2, 3, 5].map((count) => say("pieces", { count })), ["1 kos", "2 kosa", "3 kosi", "5 kosov"]);
});

test("a key without words is an error, not an empty page", () => {
  assert.throws(() => say("no.such_key"), /no words for no\.such_key/);
});

test("numbers and percentages are written as in the language", () => {
  assert.equal(sayNumber(1234.5, 1), "1234.5");
  useWords("de", { "unit.percent": "{value} %" });
  assert.equal(sayNumber(1.25, 2), "1,25");
  assert.equal(sayPercent(0.0312, 1), "3,1 %");
  assert.equal(sayPercent(0.5), "50 %");
});

test("the scripts have no sentences of their own", () => {
  const found = [];
  for (const name of readdirSync(PAGES, { recursive: true }).filter((path) => path.endsWith(".js"))) {
    const code = readFileSync(new URL(name.replaceAll("\\", "/"), PAGES), "utf8")
      .replace(/\/\*[\s\S]*?\*\/|^\s*\/\/.*$/gm, "")
      .replace(/new Error\(.*/g, "")
      .replace(/(matches|closest|querySelector|querySelectorAll|matchMedia)\(.*|takers = .*/g, "");
    for (const [text] of code.matchAll(/["'`][A-Z][a-z]+ [a-z][^"'`]*["'`]|textContent: "[A-Za-z]+"/g)) found.push(`${name}: ${text}`);
  }
  assert.deepEqual(found, []);
});
