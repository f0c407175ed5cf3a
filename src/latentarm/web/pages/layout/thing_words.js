/** Things, goals, robots and tasks in words. What no catalogue knows, such as a plug-in's things, is called by its own name. */

import { knows, say } from "./words.js";

/** How it is called next to it. @param {string} name as in the scene */
export function thingWords(name) {
  return inWords(name, "");
}

/** How it is called in a sentence about what is done with it: "the left cup". @param {string} name */
export function theThing(name) {
  return inWords(name, ".the");
}

/** Where something is put: "in the bin". @param {string} name */
export function intoThing(name) {
  return inWords(name, ".into");
}

/** The name of a zone in which the arm is slow. @param {string} name from the zones file */
export function zoneWords(name) {
  return wordsOr(`zone.name.${name.toLowerCase()}`, name);
}

/** The name of a robot. @param {string} name in its model */
export function robotWords(name) {
  return wordsOr(`robot.${name}`, name);
}

/** The name of a task. @param {string} name in the catalogue of tasks */
export function taskTitle(name) {
  return wordsOr(`task.name.${name}`, name.replaceAll("_", " "));
}

/** @param {string} name @param {string} form */
function inWords(name, form) {
  // Where a recording ended, of a run that does not say at which task it was recorded.
  const end = /^end (\d+)$/.exec(name);
  if (end) return say("thing.end", { number: end[1] });
  const key = `thing.${name.toLowerCase().replace(/\W+/g, "_")}`;
  return wordsOr(key + form, wordsOr(key, name));
}

/** The catalogue's words, or else these. @param {string} key @param {string} otherwise */
function wordsOr(key, otherwise) {
  return knows(key) ? say(/** @type {WordKey} */ (key)) : otherwise;
}

/** A sentence's first letter. @param {string} text */
export function capital(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
