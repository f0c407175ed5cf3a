/** What the Drive page says: modes, belief, recording, predicted paths, directions and places. */

import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { nextSteering } from "#pages/drive/modes.js";
import { attachProfileChoice } from "#pages/drive/profile_choice.js";
import { recordingWords } from "#pages/drive/recording.js";
import { whereWords } from "#pages/drive/where_words.js";
import { deflectionWords } from "#pages/inputs/stick.js";
import { NO_PROFILE, Settings } from "#pages/settings/settings.js";
import { motionWords } from "#pages/views/directions.js";
import { isLikeliest } from "#pages/views/likeliest.js";
import { directionColour } from "#pages/views/colours.js";
import { personalPaths, personalRing } from "#pages/views/predictions.js";
import { FakeElement, newBrowser, stateOf, welcomeOf } from "./browser.js";

beforeEach(newBrowser);

test("one button reaches every mode and every pair of axes, and comes round", () => {
  const welcome = welcomeOf();
  let now = { mode: "latent", axes: 0 };
  const seen = [];
  for (let press = 0; press < 5; press += 1) {
    now = nextSteering(welcome, now);
    seen.push(`${now.mode} ${now.axes}`);
  }
  assert.deepEqual(seen, ["end_effector 0", "end_effector 1", "end_effector 2", "latent 0", "end_effector 0"]);
});

test("a mode that is not offered is followed by the first one", () => {
  assert.deepEqual(nextSteering(welcomeOf({ modes: ["end_effector"] }), { mode: "latent", axes: 0 }), { mode: "end_effector", axes: 0 });
});

test("a goal is marked as the likeliest only where it stands out", () => {
  assert.ok(!isLikeliest([0.34, 0.33, 0.33], 0));
  assert.ok(isLikeliest([0.5, 0.3, 0.2], 0));
  assert.ok(!isLikeliest([0.5, 0.3, 0.2], 1));
  assert.ok(!isLikeliest([1], 0));
  assert.ok(!isLikeliest(null, 0));
});

for (const [recording, you, words] of [
  [null, true, "Nothing recorded yet."],
  [null, false, "Only the driver can record."],
  [{ on: false, samples: 0, episodes: 1, problem: null }, true, "1 recording kept."],
  [{ on: false, samples: 0, episodes: 2, problem: null }, true, "2 recordings kept."],
  [{ on: true, samples: 250, episodes: 2, problem: null }, true, "Recording 3: 2 s."],
  [{ on: true, samples: 250, episodes: 2, problem: null }, false, "Recording 3: 2 s."],
]) {
  test(`recording: ${words}`, () => assert.equal(recordingWords({ recording, you, phase: "moving", guiding: null }), words));
}

test("a recording of an arm that is not enabled says what is missing", () => {
  const recording = { on: true, samples: 250, episodes: 0, problem: null };
  const words = (fields) => recordingWords({ recording, you: true, phase: "disengaged", guiding: null, ...fields });
  assert.match(words({}), /^Recording 1: 2 s\. The arm is not enabled/);
  assert.match(words({ guiding: "offered", phase: "neutral_needed" }), /not enabled/);
  for (const guiding of ["on", "own"]) assert.equal(words({ guiding }), "Recording 1: 2 s.");
});

test("where the stick is, is said with its parts", () => {
  assert.equal(deflectionWords(0, 0), "Centre");
  assert.equal(deflectionWords(-0.25, 0.5), "up 50 %, left 25 %");
  assert.equal(deflectionWords(1, 0.001), "right 100 %");
});

test("a motion is named as the person sees it", () => {
  assert.equal(motionWords([0.1, 0, 0], "facing"), "towards you: 10 cm");
  assert.equal(motionWords([0.1, 0, 0], "behind"), "away from you: 10 cm");
  assert.equal(motionWords([0, 0.1, 0], "facing"), "right: 10 cm");
  assert.equal(motionWords([0, 0.1, 0], "behind"), "left: 10 cm");
});

test("a motion is named by its large parts, the largest first", () => {
  assert.equal(motionWords([0.01, 0.06, 0.1], "facing"), "up, right: 12 cm");
  assert.equal(motionWords([0, 0, 0.004], "facing"), "hardly moves, or only turns");
});

const WHERE = { tool: [0.5, 0.1, 0.2], belief: null, things: null };
const GOALS = [{ name: "tofu", position: [1, 0, 0] }, { name: "tea", position: [0.5, 0, 0.2] }];

test("the tool's place is said from the table and from the nearest goal", () => {
  assert.equal(whereWords({ goals: GOALS, things: [] }, WHERE), "The tool is 20 cm up, 10 cm from tea.");
  assert.equal(whereWords({ goals: [], things: [] }, WHERE), "The tool is 20 cm up.");
  assert.equal(whereWords({ goals: GOALS, things: [] }, WHERE, "tofu"), "The tool is 20 cm up, 55 cm from the tofu.");
});

test("what the robot thinks is meant is named with its distance, to where the food lies now", () => {
  const state = { ...WHERE, belief: [0.98, 0.02] };
  const things = [{ name: "dish", position: [0, 0, 0] }, { name: "tofu", position: [0.5, 0.1, 0.1] }];
  const said = (centimetres) => `The tool is 20 cm up. The robot thinks you want: tofu, ${centimetres} cm away.`;
  assert.equal(whereWords({ goals: GOALS, things: [] }, state), said(55));
  assert.equal(whereWords({ goals: GOALS, things }, state), said(10));
  const moved = { grains: [], poses: [[0, 0, 0, 1, 0, 0, 0], [0.5, 0.4, 0.2, 1, 0, 0, 0]] };
  assert.equal(whereWords({ goals: GOALS, things }, { ...state, things: moved }), said(30));
});

const GHOSTS = {
  up: [[0, 0, 0.1], [0, 0, 0.2]],
  down: [[0, 0, -0.1], [0, 0, -0.2]],
  left: [[0, 0.1, 0], [0, 0.2, 0]],
  right: [[0, -0.1, 0], [0, -0.2, 0]],
};
const ends = (paths) => Object.fromEntries(Object.entries(paths).map(([name, path]) => [name, path && path[path.length - 1]]));

test("predicted paths are those of the person's own directions", () => {
  const swapped = personalPaths(GHOSTS, [0, 0, 0], (x, y) => [y, x]);
  assert.deepEqual(ends(swapped), { up: [0, -0.2, 0], down: [0, 0.2, 0], left: [0, 0, -0.2], right: [0, 0, 0.2] });
});

test("a person with half the sensitivity is shown half the way", () => {
  const paths = personalPaths(GHOSTS, [0, 0, 0], (x, y) => [x / 2, y / 2]);
  assert.deepEqual(paths.up, [[0, 0, 0], [0, 0, 0.1]]);
});

test("a direction that a one-axis run does not have has no path", () => {
  const paths = personalPaths(GHOSTS, [0, 0, 0], (x) => [x]);
  assert.equal(paths.up, null);
  assert.deepEqual(ends(paths).right, [0, -0.2, 0]);
});

test("nothing is predicted before the server has", () => {
  assert.deepEqual(personalPaths(null, [0, 0, 0], (x, y) => [x, y]), { up: null, down: null, left: null, right: null });
});

/** A ring on which the tool goes where the stick points, 8 directions of it. */
const RING = Array.from({ length: 8 }, (_, index) => [Math.cos((index * Math.PI) / 4), Math.sin((index * Math.PI) / 4), 0, 1, 0, 0, 0]);
const leads = (ring) => ring.map(([x, y]) => Math.round(Math.atan2(y, x) / (Math.PI / 4)));

test("the ring goes round the person's own stick", () => {
  const tool = [0, 0, 0];
  const ring = (shaped) => leads(personalRing({ ring: RING }, tool, shaped));
  assert.deepEqual(ring((x, y) => [x, y]), [0, 1, 2, 3, 4, -3, -2, -1]);
  assert.deepEqual(ring((x, y) => [y, x]), [2, 1, 0, -1, -2, -3, 4, 3]);
  // Straight lines: what is up for the person is along the base frame's first axis.
  assert.deepEqual(ring((x, y) => [y, -x]), [-2, -1, 0, 1, 2, 3, 4, -3]);
});

test("the ring of a person with half the sensitivity is half as wide, about the tool", () => {
  const ring = personalRing({ ring: RING }, [1, 0, 0], (x, y) => [x / 2, y / 2]);
  assert.deepEqual(ring[0], [1, 0, 0, 1, 0, 0, 0]);
  assert.deepEqual(ring[4], [0, RING[4][1] / 2, 0, 1, 0, 0, 0]);
});

test("there is no ring for a stick of one axis, and none before all of it is known", () => {
  assert.deepEqual(personalRing({ ring: RING }, [0, 0, 0], (x) => [x]), []);
  const unknown = { up: [], down: [], left: [], right: [], ring: [] };
  assert.deepEqual(personalRing(unknown, [0, 0, 0], (x, y) => [x, y]), []);
  assert.deepEqual(personalPaths(unknown, [0, 0, 0], (x, y) => [x, y]), { up: null, down: null, left: null, right: null });
});

test("a direction of the stick has the colour of its arrow, or one between those of its two neighbours", () => {
  const mix = (from, to, percent) => `color-mix(in oklch, var(--ghost-${from}), var(--ghost-${to}) ${percent}%)`;
  const quarters = [["right", "up"], ["up", "left"], ["left", "down"], ["down", "right"]];
  quarters.forEach(([from, to], quarter) => {
    for (const percent of [0, 12.5, 50, 87.5]) {
      assert.equal(directionColour((quarter + percent / 100) / 4), mix(from, to, percent));
    }
  });
});

/** What is asked of the server where the person's settings name an alignment. */
function profilesAsked(profile, state, welcome = welcomeOf({ profiles: ["ada"] })) {
  const sent = [];
  const connection = Object.assign(new EventTarget(), {
    state: stateOf(state), welcome, driving: true, engaged: false,
    send: ({ name }) => name === connection.state.profile || sent.push(name),
  });
  const settings = new Settings();
  settings.change({ profile });
  attachProfileChoice(connection, settings);
  for (let times = 0; times < 3; times += 1) connection.dispatchEvent(new Event("state"));
  return sent;
}

test("the alignment of the person's choice is asked for once", () => {
  assert.deepEqual(profilesAsked("ada", {}), ["ada"]);
  assert.deepEqual(profilesAsked(NO_PROFILE, { profile: "bea" }), [null]);
});

test("no alignment is asked for without a choice, where it is on already, is not there, or another is tried", () => {
  assert.deepEqual(profilesAsked("", { profile: "bea" }), []);
  assert.deepEqual(profilesAsked("ada", { profile: "ada" }), []);
  assert.deepEqual(profilesAsked("gone", {}), []);
  assert.deepEqual(profilesAsked("ada", { profile: ".trial" }), []);
});

test("where the person sits is said once, when it changes, and when they drive again", () => {
  const sent = [];
  const connection = Object.assign(new EventTarget(), {
    state: stateOf({ profile: "bea" }), welcome: welcomeOf({ profiles: ["bea"] }), driving: true, engaged: false,
    send: (message) => sent.push(message),
  });
  const settings = new Settings();
  attachProfileChoice(connection, settings);
  const said = () => {
    for (let times = 0; times < 3; times += 1) connection.dispatchEvent(new Event("state"));
    return sent.splice(0);
  };
  assert.deepEqual(said(), [{ type: "profile", name: "bea", seat: "facing" }]);
  connection.engaged = true;
  settings.change({ seat: "behind" });
  assert.deepEqual(said(), []);
  connection.engaged = false;
  assert.deepEqual(said(), [{ type: "profile", name: "bea", seat: "behind" }]);
  connection.driving = false;
  assert.deepEqual(said(), []);
  connection.driving = true;
  assert.deepEqual(said(), [{ type: "profile", name: "bea", seat: "behind" }]);
});
