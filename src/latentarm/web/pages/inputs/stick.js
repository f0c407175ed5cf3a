/** The stick, drawn on a grid by the template: a pointer or a finger pushes it, and letting go lets it spring back. */

import { byId, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { attachHeldPointer } from "./held_pointer.js";

const SIZE = 264;
/** From the middle to where the input is 1, in the drawing's units. */
export const REACH = 96;

/** @param {PersonInput} inputs @param {Settings} settings */
export function attachStick(inputs, settings) {
  const [element, spoken] = [byId("stick"), byId("stick-value")];
  const [dead, arm, knob, mark] = [".dead", ".arm", ".knob", ".mark"].map((name) => /** @type {SVGElement} */ (element.querySelector(name)));

  const push = (/** @type {PointerEvent} */ event) => {
    const box = element.getBoundingClientRect();
    const unit = (REACH / SIZE) * box.width;
    const pushed = [event.clientX - box.left - box.width / 2, box.top + box.height / 2 - event.clientY];
    const [x, y] = pushed.map((px) => Math.min(Math.max(px / unit, -1), 1));
    inputs.hold("pointer", x, y, settings.values.press === "latch", 0, event.pointerType);
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
    knob.style.transform = `translate(${x * REACH}px, ${-y * REACH}px)`;
    arm.style.transform = `rotate(${Math.atan2(-y, x)}rad) scaleX(${Math.hypot(x, y)})`;
    setText(spoken, deflectionWords(x, y));
  };
  inputs.addEventListener("change", show);
  const outline = () => dead.setAttribute("r", String(settings.values.deadZone * REACH));
  whenever(settings, ["change"], outline);
  show();

  return {
    /** A dot that stays, or none. @param {[number, number] | null} at */
    mark(at) {
      mark.setAttribute("visibility", at ? "visible" : "hidden");
      if (at) mark.setAttribute("transform", `translate(${at[0] * REACH} ${-at[1] * REACH})`);
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
