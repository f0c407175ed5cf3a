/** Steps, outcome and time of a task in words, and where the thing of a step is. */

import { capital, intoThing, theThing, thingWords } from "../layout/thing_words.js";
import { say, sayPercent } from "../layout/words.js";

/** @import {Fill, StepToDo, TaskState} from "../connection/messages.js" */

/** A turn that need not be told, degrees. */
const SMALL_TURN = 10;

/** A step's task in words. @param {StepToDo} step */
export function stepWords({ kind, thing }) {
  return capital(say(`task.step.${kind}`, { thing: kind === "placed" ? intoThing(thing) : theThing(thing) }));
}

/** Index of the step that is to be done now. @param {Pick<TaskState, "done" | "lost">} task */
export function stepNow({ done, lost }) {
  return lost?.step ?? done;
}

/** Whether the step under way cannot be done any more. @param {Pick<TaskState, "lost" | "short">} task */
export function stuck({ lost, short }) {
  return short || lost !== null;
}

/** Why, and what to do; empty where all is well. @param {Pick<TaskState, "lost" | "short">} task */
export function stuckWords({ lost, short }) {
  if (short) return say("task.short");
  return lost ? say("task.lost", { thing: theThing(lost.thing) }) : "";
}

/** How full a cup or a bowl is. @param {Fill} fill */
export function fillWords({ thing, share, enough }) {
  const told = { thing: capital(thingWords(thing)), share: sayPercent(share) };
  return enough === null ? say("task.fill_from", told) : say("task.fill_into", { ...told, enough: sayPercent(enough) });
}

/** How a run has ended; empty while it goes on. @param {TaskState} task */
export function outcomeWords({ outcome, why, time_s }) {
  if (outcome === "success") return say("task.success", { seconds: Math.round(time_s) });
  if (why === null) return "";
  return say("task.failure", { what: say(`task.failed.${why.code}`, { thing: theThing(why.thing) }) });
}

/** Why another run cannot be begun now; empty if it can. @param {Pick<State, "you" | "phase">} state */
export function blockedWords({ you, phase }) {
  if (!you) return say("task.blocked.watching");
  if (phase === "ready" || phase === "moving") return say("task.blocked.engaged");
  return phase === "stopping" ? say("task.blocked.stopping") : "";
}

/** Where a thing is now, m, or the tool's place at a goal that is no thing; else null. @param {string} name @param {Welcome} welcome @param {State} state */
export function placeOf(name, welcome, state) {
  const index = welcome.things.findIndex((thing) => thing.name === name);
  if (index >= 0) return state.things?.poses[index]?.slice(0, 3) ?? welcome.things[index].position;
  return welcome.goals.find((goal) => goal.name === name)?.position ?? null;
}

/** The thing of the current step; null where nothing is left to do. @param {Welcome} welcome @param {State} state */
export function wantedThing(welcome, state) {
  return state.task.outcome === null ? welcome.task.steps[stepNow(state.task)]?.thing ?? null : null;
}

/** From the tool to a place, m. @param {number[]} tool @param {number[]} place */
export function distance(tool, place) {
  return Math.hypot(...tool.map((at, axis) => at - place[axis]));
}

/** How far the tool has to go in the step that is to be done now, and to turn; along straight lines the list says it. @param {State} state */
export function awayWords({ mode, task: { outcome, to_go } }) {
  if (to_go === null || outcome !== null || to_go.gripper || mode === "end_effector") return "";
  const [centimetres, degrees] = [100 * Math.hypot(...to_go.shift_m), (180 * Math.hypot(...to_go.turn_rad)) / Math.PI].map(Math.round);
  return degrees > SMALL_TURN ? say("task.away_turn", { centimetres, degrees }) : say("task.away", { centimetres });
}
