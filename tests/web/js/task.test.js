/** The task's panel: steps tick off, the end is said, heard and timed, and another run begins only with the arm at rest. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { attachTask } from "#pages/drive/task_panel.js";
import { blockedWords, fillWords, outcomeWords, stepWords } from "#pages/drive/task_words.js";
import { theThing, thingWords } from "#pages/layout/thing_words.js";
import { useWords } from "#pages/layout/words.js";
import { Settings } from "#pages/settings/settings.js";
import german from "../../../src/latentarm/web/words/de.json" with { type: "json" };
import spanish from "../../../src/latentarm/web/words/es.json" with { type: "json" };
import chinese from "../../../src/latentarm/web/words/zh.json" with { type: "json" };
import { elementsOf, event, FakeElement, newBrowser, pass, stateOf, welcomeOf } from "./browser.js";

const MARSHMALLOWS = ["left marshmallow", "middle marshmallow", "right marshmallow"];
const STEPS = [{ kind: "above", thing: MARSHMALLOWS[0] }, { kind: "stabbed", thing: MARSHMALLOWS[0] }];
const RUN = { choice: 0, done: 0, outcome: null, why: null, time_s: 0, to_go: null, lost: null, fills: [], short: false };

let fakes;
let parts;
let connection;
let sent;
let heard;
let task;

function welcomes(fields = {}) {
  const todo = { name: "marshmallows", seed: 0, choices: MARSHMALLOWS, choice: 0, steps: STEPS, ...fields };
  const things = [{ name: MARSHMALLOWS[0], position: [0.5, 0, 0.1] }];
  connection.welcome = welcomeOf({ task: todo, things });
  connection.dispatchEvent(new Event("welcome"));
}

const FAR = { shift_m: [0, 0, -0.2], turn_rad: [0, 0, 0], gripper: null };

/** The server says how far the run has come. */
function hears(run = {}, fields = {}) {
  connection.state = stateOf({ task: { ...RUN, ...run }, tool: [0.5, 0, 0.3], you: true, ...fields });
  connection.dispatchEvent(new Event("state"));
  pass(300);
}

beforeEach(() => {
  fakes = newBrowser();
  parts = elementsOf({
    panel: "task", steps: "task-steps", fills: "task-fills", said: "task-said", time: "task-time", why: "task-why",
    chooser: "task-chooser", choice: "task-choice", next: "task-next", again: "task-again", more: "task-more",
  });
  parts.panel.hidden = true;
  sent = [];
  heard = [];
  connection = Object.assign(new EventTarget(), { welcome: null, state: null, send: (message) => sent.push(message) });
  task = attachTask(connection, (outcome) => heard.push(outcome));
});

const marks = () => parts.steps.children.map((item) => ({ done: "✓", now: "▸", later: "○" })[item.dataset.step]).join("");
const press = (part) => parts[part].dispatchEvent(event("click"));

test("without steps there is no panel, and nothing to choose", () => {
  welcomes({ steps: [] });
  hears();
  assert.ok(parts.panel.hidden);
  assert.deepEqual(task(), []);
});

test("steps tick off, and each is said with the next", () => {
  welcomes();
  hears();
  assert.ok(!parts.panel.hidden);
  assert.equal(marks(), "▸○");
  assert.equal(parts.said.textContent, "");
  hears({ done: 1, time_s: 3.4 });
  assert.equal(marks(), "✓▸");
  assert.equal(parts.said.textContent, "Step 1 of 2 is done. Now: Stab the left marshmallow and lift it.");
  assert.deepEqual(heard, []);
});

test("the distance that is left is told at the step that is to be done", () => {
  welcomes();
  hears({ to_go: FAR });
  const away = () => parts.steps.children.map((item) => item.children[2].textContent);
  assert.deepEqual(away(), ["20 cm to go", ""]);
  hears({ to_go: { ...FAR, shift_m: [0, 0, -0.05] } });
  assert.deepEqual(away(), ["5 cm to go", ""]);
  // With straight lines each direction has its own distance in the list, and the step has none.
  hears({ to_go: FAR }, { mode: "end_effector" });
  assert.deepEqual(away(), ["", ""]);
});

test("success is said with its time, and heard once", () => {
  welcomes();
  hears({ done: 1 });
  hears({ done: 2, outcome: "success", time_s: 12.6 });
  hears({ done: 2, outcome: "success", time_s: 12.6 });
  assert.equal(parts.said.textContent, "Done! Well driven. It took 13 s.");
  assert.equal(parts.panel.dataset.outcome, "success");
  assert.equal(parts.time.textContent, "Time: 13 s");
  assert.equal(marks(), "✓✓");
  assert.deepEqual(heard, ["success"]);
});

test("a page that comes when all is over makes no sound, and is not told what others did, nor how long that took", () => {
  welcomes();
  hears({ done: 2, outcome: "success", time_s: 12.6 });
  assert.deepEqual(heard, []);
  assert.equal(parts.said.textContent, "This task is over.");
  assert.equal(parts.time.textContent, "");
  hears();
  hears({ done: 2, outcome: "success", time_s: 8 });
  assert.equal(parts.time.textContent, "Time: 8 s");
});

test("failure says what happened", () => {
  welcomes();
  hears({ done: 1 });
  hears({ done: 1, outcome: "failure", why: { code: "dropped", thing: MARSHMALLOWS[0] } });
  assert.equal(parts.said.textContent, "The arm dropped the left marshmallow. You can try again.");
  assert.deepEqual(heard, ["failure"]);
  hears();
  assert.equal(parts.said.textContent, "");
});

test("what slipped is said, its step is to be done again, and then the steps go on", () => {
  welcomes();
  hears({ done: 1 });
  hears({ done: 2, lost: { thing: MARSHMALLOWS[0], step: 0 }, to_go: FAR });
  assert.equal(parts.said.textContent, "The arm no longer holds the left marshmallow.");
  assert.equal(marks(), "▸✓");
  assert.equal(parts.panel.dataset.outcome, "stuck");
  assert.deepEqual(parts.steps.children.map((item) => item.children[2].textContent), ["20 cm to go", ""]);
  assert.deepEqual(task().map(({ id }) => id), ["next", "again"]);
  assert.deepEqual(heard, []);
  hears({ done: 1 });
  assert.equal(marks(), "✓▸");
  assert.equal(parts.said.textContent, "Step 1 of 2 is done. Now: Stab the left marshmallow and lift it.");
});

test("too little to pour is said", () => {
  welcomes();
  hears({ done: 1, short: true });
  assert.equal(parts.said.textContent, "Too little is left to pour.");
  assert.deepEqual(task().map(({ id }) => id), ["next", "again"]);
});

test("how full things are is told where something is poured, in every language", () => {
  welcomes();
  hears();
  assert.ok(parts.fills.hidden);
  const fills = [{ thing: "cup", share: 0.4, enough: null }, { thing: "left bowl", share: 0.6, enough: 0.8 }];
  const told = () => parts.fills.children.map((item) => item.textContent);
  hears({ fills });
  assert.ok(!parts.fills.hidden);
  assert.deepEqual(told(), ["Cup: 40 % left", "Left bowl: 60 % in, 80 % is enough"]);
  for (const [language, words, bowl] of [["de", german, "Linke Schale"], ["es", spanish, "Cuenco izquierdo"], ["zh", chinese, "左边的碗"]]) {
    useWords(language, words);
    assert.ok(fillWords(fills[1]).startsWith(bowl));
    assert.match(fillWords(fills[1]), /60\s?%.*80\s?%/u);
  }
});

for (const [fields, why] of [
  [{ you: true, phase: "ready" }, "Press Stop first. Then you can go on."],
  [{ you: true, phase: "moving" }, "Press Stop first. Then you can go on."],
  [{ you: true, phase: "stopping" }, "Wait until the arm stands still."],
  [{ you: false, phase: "disengaged" }, "Only the person who drives can go on."],
]) {
  test(`nothing begins, and it is said why: ${why} (${fields.phase})`, () => {
    welcomes();
    hears({}, fields);
    press("next");
    press("again");
    assert.deepEqual(sent, []);
    assert.equal(parts.why.textContent, why);
    assert.equal(parts.next.getAttribute("aria-disabled"), "true");
    assert.deepEqual(task(), []);
    assert.equal(blockedWords(fields), why);
  });
}

test("Next is the next choice placed anew, after the last the first; Again is the same", () => {
  welcomes();
  hears();
  press("next");
  press("again");
  welcomes({ choice: 2 });
  hears({ choice: 2 });
  press("next");
  assert.deepEqual(sent, [
    { type: "begin_run", choice: 1, anew: true },
    { type: "begin_run", choice: null, anew: false },
    { type: "begin_run", choice: 0, anew: true },
  ]);
});

test("another thing can be chosen", () => {
  welcomes();
  hears();
  parts.choice.value = "2";
  parts.choice.dispatchEvent(event("change"));
  assert.deepEqual(sent, [{ type: "begin_run", choice: 2, anew: false }]);
});

test("one switch reaches Next, and Again once it is over", () => {
  welcomes();
  hears();
  assert.deepEqual(task().map(({ id }) => id), ["next"]);
  hears({ done: 2, outcome: "success" });
  assert.deepEqual(task().map(({ id }) => id), ["next", "again"]);
  task()[0].act();
  assert.deepEqual(sent, [{ type: "begin_run", choice: 1, anew: true }]);
});

test("every language says what is done with what", () => {
  const put = { kind: "placed", thing: "own plate" };
  assert.equal(stepWords(put), "Put it on your plate");
  const why = { code: "spilled", thing: "grains" };
  useWords("de", german);
  assert.equal(stepWords(STEPS[0]), "Über das linke Marshmallow fahren");
  assert.equal(stepWords(put), "Auf Ihren Teller legen");
  assert.match(outcomeWords({ ...RUN, outcome: "failure", why }), /^Der Arm hat die Körner verschüttet\./);
  useWords("es", spanish);
  assert.equal(stepWords(STEPS[0]), "Ir por encima hasta el malvavisco izquierdo");
  assert.equal(stepWords(put), "Ponerlo en su plato");
  assert.match(outcomeWords({ ...RUN, outcome: "failure", why }), /^El brazo derramó los granos\./);
  useWords("zh", chinese);
  assert.equal(stepWords(STEPS[0]), "移到左边的棉花糖上方");
  assert.equal(stepWords(put), "把它放到您的盘子里");
  assert.match(outcomeWords({ ...RUN, outcome: "failure", why }), /^机械臂把谷粒弄洒了。/);
});

test("a thing of a plug-in is called by its own name", () => {
  assert.equal(thingWords("Blue Lid"), "Blue Lid");
  assert.equal(theThing("constructor"), "constructor");
});
