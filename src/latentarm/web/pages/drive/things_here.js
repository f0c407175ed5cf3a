/** Where the things are: how each place is known, and buttons by which a person says that the tool is at a thing. */

import { byId, create, createButton, setHidden, setText } from "../layout/dom.js";
import { capital, theThing, thingWords } from "../layout/thing_words.js";
import { say } from "../layout/words.js";

/** @typedef {NonNullable<State["things"]>["seen"][number]} SeenThing */

/** How old a sighting is before its age is told, s. */
const FRESH_S = 2;
const KINDS = /** @type {const} */ (["place", "front", "undo"]);

/** How a thing's place is known, in words; "" where it is seen now, or a person has shown it. @param {SeenThing} thing */
export function seenWords({ name, seen, age_s, source }) {
  if (seen === "seen" && (age_s < FRESH_S || source === "touch")) return "";
  return capital(say(`things.${seen}`, { thing: thingWords(name), seconds: age_s }));
}

/** @param {Connection} connection @returns {() => Choice[]} the buttons among the choices of a switch */
export function attachThingsHere(connection) {
  const list = byId("things-list");
  const seen = () => connection.state?.things?.seen ?? [];
  const choices = () => !connection.driving ? [] : seen().flatMap(({ name, seen: how }) => KINDS.filter((kind) => kind === "place" || how !== "unseen").map((kind) => (
    { id: `thing-${kind}-${name}`, label: say(`things.${kind}`, { thing: theThing(name) }), act: () => connection.send({ type: "touch", thing: name, kind }) })));
  let shown = "";
  connection.addEventListener("state", () => {
    setHidden(byId("things-here"), seen().length === 0);
    const offered = choices();
    const now = offered.map(({ id }) => id).join();
    if (now !== shown || !list.children.length) {
      shown = now;
      list.replaceChildren(...seen().map(({ name }) => {
        const buttons = offered.filter(({ id }) => id.endsWith(`-${name}`)).map(({ label, act }) => createButton(label, act));
        return create("li", { className: "row" }, create("p", { className: "small" }), ...buttons);
      }));
    }
    seen().forEach((thing, index) => setText(list.children[index].children[0], seenWords(thing) || say("things.now", { thing: capital(thingWords(thing.name)) })));
  });
  return choices;
}
