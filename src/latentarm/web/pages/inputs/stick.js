/** The stick drawn on a grid: a pointer or a finger pushes it, and letting go lets it spring back. */

import { byId, part, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { attachHeldPointer } from "./held_pointer.js";

/** @import {Direction, PersonInput} from "./deflection.js" */
/** @import {Settings} from "../settings/settings.js" */

const SIZE = 264;
/** From the middle to where the input is 1, in the drawing's units. */
export const REACH = 96;
const CELLS = 8;

/** @param {PersonInput} inputs @param {Settings} settings */
export function attachStick(inputs, settings) {
  const [element, spoken] = [byId("stick"), byId("stick-value")];
  const drawing = draw(element);

  const push = (/** @type {PointerEvent} */ event) => {
    const box = element.getBoundingClientRect();
    const unit = (REACH / SIZE) * box.width;
    const x = clamp((event.clientX - box.left - box.width / 2) / unit);
    const y = clamp(-(event.clientY - box.top - box.height / 2) / unit);
    inputs.hold("pointer", x, y, settings.values.press === "latch");
  };
  const letGo = () => inputs.release("pointer");

  const forget = attachHeldPointer(element, {
    begins: (event) => {
      event.preventDefault();
      element.focus({ preventScroll: true });
      // A second press on a stick that stays where it was put takes it back.
      if (inputs.source === "pointer") {
        letGo();
        return false;
      }
      push(event);
      return true;
    },
    moves: push,
    ends: () => {
      const stays = settings.values.press === "latch" && inputs.live && inputs.source === "pointer";
      if (!stays) letGo();
    },
    missed: letGo,
    lost: () => inputs.halt("pointer_lost"),
  });
  inputs.addEventListener("dropped", forget);
  const show = () => {
    const [x, y] = [inputs.x, inputs.y];
    drawing.knob.setAttribute("transform", `translate(${x * REACH} ${-y * REACH})`);
    drawing.arm.setAttribute("x2", String(x * REACH));
    drawing.arm.setAttribute("y2", String(-y * REACH));
    setText(spoken, deflectionWords(x, y));
  };
  inputs.addEventListener("change", show);
  const outline = () => drawing.dead.setAttribute("r", String(settings.values.deadZone * REACH));
  whenever(settings, ["change"], outline);
  show();

  return {
    /** A dot that stays, or none. @param {[number, number] | null} at */
    mark(at) {
      drawing.mark.setAttribute("visibility", at ? "visible" : "hidden");
      if (at) drawing.mark.setAttribute("transform", `translate(${at[0] * REACH} ${-at[1] * REACH})`);
    },
  };
}

/** Where the stick is: "up 50 %, left 20 %". @param {number} x @param {number} y */
export function deflectionWords(x, y) {
  const across = Math.round(Math.abs(x) * 100);
  const along = Math.round(Math.abs(y) * 100);
  const said = [];
  if (along) said.push(say(y > 0 ? "stick.up" : "stick.down", { percent: along }));
  if (across) said.push(say(x > 0 ? "stick.right" : "stick.left", { percent: across }));
  return said.join(", ") || say("stick.centre");
}

/** @param {number} value */
function clamp(value) {
  return Math.min(Math.max(value, -1), 1);
}

/** @param {HTMLElement} element */
function draw(element) {
  const half = SIZE / 2;
  const svg = part("svg", { viewBox: `${-half} ${-half} ${SIZE} ${SIZE}`, "aria-hidden": "true" });
  svg.append(part("rect", { class: "pad", x: 1 - half, y: 1 - half, width: SIZE - 2, height: SIZE - 2, rx: 10 }));
  for (let cell = -CELLS / 2; cell <= CELLS / 2; cell += 1) {
    const at = (cell * REACH) / (CELLS / 2);
    const kind = cell === 0 ? "axis" : "grid-line";
    svg.append(part("line", { class: kind, x1: at, x2: at, y1: -REACH, y2: REACH }));
    svg.append(part("line", { class: kind, y1: at, y2: at, x1: -REACH, x2: REACH }));
  }
  const dead = part("circle", { class: "dead" });
  const arm = part("line", { class: "arm", x1: 0, y1: 0 });
  const knob = part("g", {});
  knob.append(part("circle", { class: "knob", r: 31 }));
  svg.append(dead, arm);
  for (const [name, y] of /** @type {[Direction, number][]} */ ([["up", 5 - REACH - 14], ["down", REACH + 22]])) {
    svg.append(part("text", { x: 0, y, "text-anchor": "middle", "data-ghost": name }, say(`directions.${name}`)));
  }
  for (const [name, side] of /** @type {[Direction, number][]} */ ([["left", -1], ["right", 1]])) {
    const turn = { x: side * (REACH + 17), y: 5, transform: `rotate(${side * 90} ${side * (REACH + 17)} 0)` };
    svg.append(part("text", { ...turn, "text-anchor": "middle", "data-ghost": name }, say(`directions.${name}`)));
  }
  const mark = part("g", { class: "mark", visibility: "hidden" });
  mark.append(part("circle", { class: "mark-edge", r: 13 }), part("circle", { class: "mark-dot", r: 8 }));
  svg.append(knob, mark);
  element.replaceChildren(svg);
  return { knob, arm, dead, mark };
}
