/** Where things are: what is said of each, and what a person who drives can say by button or by switch. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachThingsHere, seenWords } from "#pages/drive/things_here.js";
import { sayTo } from "#pages/connection/notices.js";
import { elementsOf, newBrowser, stateOf } from "./browser.js";

beforeEach(newBrowser);

const thing = (fields) => ({ name: "cup", seen: "seen", age_s: 0, source: "http:8470", ...fields });

test("nothing is said of a thing that is seen now or was shown, and the age of any other", () => {
  assert.equal(seenWords(thing({})), "");
  assert.equal(seenWords(thing({ age_s: 90, source: "touch" })), "");
  assert.equal(seenWords(thing({ age_s: 3 })), "Cup: last seen 3 s ago.");
  assert.equal(seenWords(thing({ seen: "lost", age_s: 12 })), "Cup: not seen for 12 s, drawn where it was.");
  assert.equal(seenWords(thing({ seen: "unseen" })), "Cup: not seen yet.");
});

test("who drives can show things; nobody can turn what has not been seen", () => {
  const sent = [];
  const things = { poses: [], grains: [], seen: [thing({}), thing({ name: "bowl", seen: "unseen" })] };
  const connection = Object.assign(new EventTarget(), { driving: true, state: stateOf({ things }), send: (message) => sent.push(message) });
  const { section } = elementsOf({ section: "things-here", list: "things-list" });
  const choices = attachThingsHere(connection);
  assert.deepEqual(choices().map(({ label }) => label), ["Here is the cup", "Turn the cup towards the tool", "Take back: the cup", "Here is the bowl"]);
  choices()[3].act();
  assert.deepEqual(sent, [{ type: "touch", thing: "bowl", kind: "place" }]);
  connection.driving = false;
  assert.deepEqual(choices(), []);
});

test("a notice about a thing calls it as people do", () => {
  const reader = { you: true, own: { has: () => false }, late: null, absent: false };
  assert.match(sayTo({ code: "thing_lost", parameters: { thing: "left marshmallow" } }, reader), /because the left marshmallow has/);
});
