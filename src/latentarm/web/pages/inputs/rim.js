/** The rim of the stick, which wears the colours of the ring in the views: where it is pushed to is where it leads. */

import { byId, part } from "../layout/dom.js";
import { directionColour } from "../views/colours.js";
import { REACH } from "./stick.js";

const ARCS = 64;

/** On the stick, which has been drawn. @returns {SVGElement} */
export function attachRim() {
  const rim = part("g", { class: "rim" });
  const angle = (/** @type {number} */ arc) => (2 * Math.PI * arc) / ARCS;
  const at = (/** @type {number} */ arc) => `${REACH * Math.cos(angle(arc))} ${-REACH * Math.sin(angle(arc))}`;
  for (let arc = 0; arc < ARCS; arc += 1) {
    // Each reaches a little under the next one, so that no gap shows.
    const d = `M ${at(arc - 0.5)} A ${REACH} ${REACH} 0 0 0 ${at(arc + 0.6)}`;
    rim.append(part("path", { d, stroke: directionColour(arc / ARCS) }));
  }
  byId("stick").querySelector(".dead")?.before(rim);
  return rim;
}
