/** The one sentence about what to do, over all states: it never asks for what does nothing, and names who stopped the arm. */

import assert from "node:assert/strict";
import { before, test } from "node:test";

import german from "../../../src/latentarm/web/words/de.json" with { type: "json" };
import english from "../../../src/latentarm/web/words/en.json" with { type: "json" };
import spanish from "../../../src/latentarm/web/words/es.json" with { type: "json" };
import chinese from "../../../src/latentarm/web/words/zh.json" with { type: "json" };
import { enableButtonOf } from "#pages/connection/enable_button.js";
import { sentenceOf, textOf } from "#pages/connection/sentence.js";
import { useWords } from "#pages/layout/words.js";
import { STEPS } from "#pages/practice/steps.js";
import { newBrowser, pageOf, stateOf, welcomeOf } from "./browser.js";

const notice = (code, parameters = {}) => ({ code, parameters });
const REASONS = [
  notice("not_enabled"), notice("stop_pressed_by", { name: "Me", page: "me" }), notice("stop_pressed_by", { name: "Cleo", page: "cleo" }),
  notice("page_stopped", { name: "Cleo", page: "cleo" }), notice("driver_gone", { name: "Cleo", page: "cleo" }), notice("driver_released", { name: "Cleo", page: "cleo" }),
  notice("handed_over", { name: "Cleo", page: "cleo" }), notice("input_late"), notice("latch_ended", { seconds: 10 }), notice("readings_unsteady"),
  notice("idle", { seconds: 120 }), notice("copilot_ended", { name: "Cleo" }), notice("arm_emergency_stop"), notice("arm_fault", { text: "E7." }),
];
const WHO = { driver: { you: true, driver: "me", driver_name: "Me" }, watcher: { driver: "ada", driver_name: "Ada" }, nobody: {} };
const BOOLEAN = [false, true];

/** Walked in all combinations that can be. */
const WALKED = {
  phase: ["disengaged", "neutral_needed", "ready", "moving", "stopping"], who: Object.keys(WHO), lost: BOOLEAN, returning: BOOLEAN, dialog: BOOLEAN,
  practice: [null, ...STEPS], panel: ["stick", "dpad", "switch"], shadow: BOOLEAN, idle: [null, 12], absent: BOOLEAN, reason: REASONS,
};
/** Drawn for each of them. */
const DRAWN = {
  press: ["hold", "latch", "step"], switchMotion: ["latch", "hold"], late: ["page", "connection", null], unconfirmed: BOOLEAN, refused: BOOLEAN, pushAgain: BOOLEAN,
  pressed: BOOLEAN, keys: BOOLEAN, letGo: BOOLEAN, pace: [null, 0, 0.5], asking: [null, "me", "bob"], heldBack: [null, "clearance"], bound: [null, "Drink"],
  halted: [null, null, "focus_lost", "dialog_opened"], outcome: [null, null, "success"], canEnable: [true, true, true, false], canConnect: BOOLEAN, silent: [0, 0, 0, 0, 0, 500],
  note: [null, null, null, notice("checklist_first"), notice("pose_pushed", { pose: "Drink" }), notice("at_start"), notice("asking", { name: "Cleo" })],
  next: [null, { key: "status.go", parameters: { way: "Right 16 cm" } }, { key: "to_go.gripper_close" }], helped: ["latent", "assisted", "end_effector"],
};

function* combinations([[name, values], ...rest]) {
  for (const value of values) {
    if (rest.length) for (const others of combinations(rest)) yield { [name]: value, ...others };
    else yield { [name]: value };
  }
}

/** Numbers that look random and are the same in every run. */
let seed = 1;
const draw = (values) => {
  seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
  return values[Math.floor((seed / 2 ** 32) * values.length)];
};

/** Whether a combination can be: only an enabled arm is under way, and only a stopped one has a reason, or is lost. */
function canBe({ phase, lost, returning, shadow, idle, absent, reason }) {
  const engaged = phase === "ready" || phase === "moving";
  return engaged ? !lost && !absent && reason === REASONS[0] : !returning && !shadow && idle === null;
}

/** One state of the arm and the page. */
function situation(at) {
  const { phase, who, lost, returning, idle } = at;
  const engaged = phase === "ready" || phase === "moving";
  const state = stateOf({
    ...WHO[who], phase, reason: engaged ? null : at.reason, lost: lost && !engaged, returning: returning && engaged, bound_for: returning && engaged ? at.bound : null, mode: at.helped,
    idle_left_s: engaged ? idle : null, let_go_first: at.letGo, held_back: at.heldBack, note: at.note, asking: at.asking, asking_name: at.asking === "bob" ? "Bob" : "Me",
    copilot: at.pace === null ? null : { id: "x", name: "Xi", pace: at.pace },
  });
  state.task = { ...state.task, outcome: at.outcome };
  const welcome = welcomeOf({ real: at.shadow || at.unconfirmed ? { facts: [], shadow: at.shadow } : null });
  const heard = { open: true, silenceMs: at.silent, engaged, drove: state.you, own: { has: (page) => page === "me" }, welcome, state };
  const values = { panel: at.panel, press: at.press, switchMotion: at.switchMotion };
  return { at, state, heard, engaged, page: pageOf({ ...at, values }) };
}

/** Sentences that ask for a motion. */
const ASKS_TO_MOVE = /(^|[.?] )Push |: push |push again|Drive the tool|one of the four direction|[Cc]hoose a direction|Choose Right|gripper now/;
const ASKS_TO_ENABLE = /(press|Press|Choose) Enable/;
const ABOUT_KEYS = /\b(arrow|keys?|Space|Escape)\b/i;

const LAWS = {
  "a motion is asked for only where a push would move the arm"({ state, engaged, at }, text) {
    if (!ASKS_TO_MOVE.test(text)) return true;
    const heard = engaged && state.you && at.silent === 0 && !at.dialog && !at.shadow && !state.returning;
    return heard && (state.copilot?.pace !== 0 || state.phase === "moving") && (!at.letGo || state.phase === "moving" || /^Let go|: let go/.test(text));
  },
  "Enable is asked for only where it would enable, or with what comes first"({ state, heard, page, at }, text) {
    if (!ASKS_TO_ENABLE.test(text)) return true;
    if (!page.canEnable || at.dialog || state.lost || enableButtonOf(heard).does !== "enable" || at.reason.code === "arm_emergency_stop") return false;
    return (!at.unconfirmed || /Confirm/.test(text)) && (!state.you || at.unconfirmed || state.phase !== "neutral_needed" || /Let go/.test(text));
  },
  "who can enable the arm is told how"({ state, heard, page, at }, text) {
    const can = page.canEnable && !at.dialog && !state.lost && at.silent === 0 && enableButtonOf(heard).does === "enable" && !["stopping"].includes(state.phase);
    if (!can || at.reason.code === "arm_emergency_stop" || at.note) return true;
    return ASKS_TO_ENABLE.test(text) || (at.outcome !== null && /Next task/.test(text));
  },
  "a dialog is to be closed first"({ state, at, page }, text) {
    const other = at.silent || at.note || state.lost || state.phase === "stopping" || at.reason.code === "arm_emergency_stop" || !page.canEnable;
    return !at.dialog || !state.you || other || /Close the window on this page first\.$/.test(text);
  },
  "another person's stop has their name, and one's own is one's own"({ state, engaged, at }, text) {
    if (engaged || at.silent || at.note || at.refused || state.lost || at.halted || at.absent || !["stop_pressed_by", "page_stopped", "handed_over"].includes(at.reason.code)) return true;
    return at.reason.parameters.page === "me" ? /^(Stopping\. )?You pressed Stop/.test(text) : /Cleo/.test(text);
  },
  "a page that was not there is told nothing of others' drives"({ at }, text) {
    return !at.absent || at.note || !/Cleo|in time|too slow|at most|Nobody gave|not the co-pilot any more/.test(text);
  },
  "nothing is said of keys where there are none"({ at }, text) {
    return at.keys || !ABOUT_KEYS.test(text);
  },
  "a watcher is told who drives, and asked for nothing but to ask"({ state, at, heard }, text) {
    if (at.who !== "watcher" || at.silent) return true;
    if (/Confirm|Let go|You pushed/.test(text)) return false;
    if (/Press “Ask to drive”/.test(text)) return enableButtonOf(heard).does === "ask";
    return /Ada/.test(text) || Boolean(at.note) || state.returning || state.phase === "stopping";
  },
  "a lost arm is to be connected, and nothing else"({ state, at, page }, text) {
    if (!state.lost || at.silent || at.note || at.who === "watcher" || state.phase === "stopping") return true;
    return /Connect again/.test(text) === page.canConnect && !ASKS_TO_ENABLE.test(text) && !ASKS_TO_MOVE.test(text);
  },
  "it is a whole sentence"(_, text) {
    return /^[^ {}](?!.*(undefined|null|NaN|  |[{}])).*[.…]$|^(Open|Close) the gripper now$/.test(text);
  },
};

before(newBrowser);

test("over all states no sentence contradicts the state", () => {
  const said = new Map();
  const broken = new Map();
  let walked = 0;
  for (const at of combinations(Object.entries(WALKED))) {
    if (!canBe(at)) continue;
    for (let times = 0; times < 4; times += 1) {
      for (const [name, values] of Object.entries(DRAWN)) at[name] = draw(values);
      const one = situation(at);
      const sentence = sentenceOf(one.heard, one.page);
      const text = textOf(sentence);
      said.set(text, sentence);
      walked += 1;
      for (const [law, holds] of Object.entries(LAWS)) if (!holds(one, text) && !broken.has(law)) broken.set(law, { text, ...at });
    }
  }
  assert.deepEqual([...broken], []);
  assert.ok(walked > 90_000 && said.size > 150, `${walked} states, ${said.size} sentences`);
  for (const [language, words] of Object.entries({ de: german, en: english, es: spanish, zh: chinese })) {
    useWords(language, words);
    for (const sentence of said.values()) assert.doesNotMatch(textOf(sentence), /undefined|[{}]/);
  }
});
