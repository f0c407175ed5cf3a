/** Where the tool is: how high, and how far from the food that the robot thinks is meant, in words. */

import { theThing, thingWords } from "../layout/thing_words.js";
import { say } from "../layout/words.js";
import { isLikeliest } from "../views/likeliest.js";
import { distance, placeOf } from "./task_words.js";

/** @param {Welcome} welcome @param {State} state @param {string | null} [thing] what the task is about now */
export function whereWords(welcome, state, thing = null) {
  const height = Math.round(100 * state.tool[2]);
  const goals = welcome.goals.map(({ name }, index) => ({
    name,
    asked: name === thing,
    away: distance(state.tool, placeOf(name, welcome, state) ?? state.tool),
    likeliest: isLikeliest(state.belief, index),
  }));
  const wanted = goals.find(({ likeliest }) => likeliest);
  const [nearest] = [...goals].sort((a, b) => a.away - b.away);
  const said = wanted ?? goals.find(({ asked }) => asked) ?? nearest;
  if (!said) return say("place.height", { height });
  const away = Math.round(100 * said.away);
  if (wanted) return say("place.wanted", { height, away, name: thingWords(said.name) });
  return say("place.near", { height, away, thing: theThing(said.name) });
}
