/** The gripper: two buttons, what every other way of driving asks of it, and its state in words. */

import { byId, setHidden, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** @import {GripperState} from "../connection/messages.js" */

/** Narrower than this share of its opening it is closed, and wider than the rest of it, open. */
const END_SHARE = 0.03;
/** The state is said once it has not changed for this long, ms: screen readers would announce every millimetre. */
const SETTLE_MS = 250;
/** The gripper of an arm that is not enabled opens after so long; the arm's own process counts it, ms. */
const HOLD_MS = 1000;

/** Open, closed or holding something, and how wide. @param {GripperState | null} gripper @param {number} widest m */
export function gripperWords(gripper, widest) {
  if (gripper === null) return say("gripper.unknown");
  const width = { millimetres: Math.round(1000 * gripper.width_m) };
  if (gripper.holding) return say("gripper.holding", width);
  if (gripper.width_m >= (1 - END_SHARE) * widest) return say("gripper.is_open", width);
  return say(gripper.width_m <= END_SHARE * widest ? "gripper.is_closed" : "gripper.is_between", width);
}

/** @param {Connection} connection @param {DriveInput} input @param {() => void} refused said when the gripper cannot be moved yet */
export function attachGripper(connection, input, refused) {
  const buttons = { open: byId("gripper-open"), close: byId("gripper-close") };
  let wanted = "";
  let timer = 0;

  /** How wide it opens, m, or null where there is no gripper. */
  const widest = () => connection.welcome?.gripper_width_m ?? null;
  const ask = (/** @type {"open" | "close" | "toggle"} */ what, /** @type {Source} */ source) => {
    if (widest() !== null && !input.ask(what, source)) refused();
  };
  /** The control that opens the gripper of an arm that is not enabled, while it is held. @type {Source | null} */
  let holding = null;
  let heldAt = NaN;
  const padPressed = () => navigator.getGamepads().some((pad) => pad?.connected && pad.buttons.some(({ pressed }) => pressed));
  const hold = (/** @type {Source} */ source) => {
    holding = source;
    const begins = input.holdOpen(source, () => holding === source && (source !== "gamepad" || padPressed()));
    heldAt = begins ? performance.now() : NaN;
    return begins;
  };
  for (const end of ["keyup", "pointerup", "pointercancel", "blur"]) window.addEventListener(end, () => (holding = null));
  // Some browsers lose the release; then the pointer moves with no button down.
  window.addEventListener("pointermove", ({ buttons }) => {
    if (holding === "pointer" && buttons === 0) holding = null;
  });
  buttons.open.addEventListener("pointerdown", () => {
    if (widest() !== null) hold("pointer");
  });
  for (const what of /** @type {("open" | "close")[]} */ (["open", "close"])) {
    const button = buttons[what];
    button.addEventListener("click", () => {
      // The click at the end of holding it asks nothing more.
      if (what === "close" || !(performance.now() - heldAt >= HOLD_MS)) ask(what, "pointer");
      heldAt = NaN;
    });
    // A second finger, while the first holds the stick, makes no click.
    button.addEventListener("pointerup", ({ isPrimary, clientX, clientY }) => {
      if (!isPrimary && button.contains(document.elementFromPoint(clientX, clientY))) ask(what, "pointer");
    });
  }
  connection.addEventListener("welcome", () => {
    byId("gripper").hidden = widest() === null;
  });
  connection.addEventListener("state", () => {
    const [{ state }, most] = [connection, widest()];
    if (!state || most === null) return;
    setHidden(byId("gripper-hold"), connection.engaged || !connection.driving);
    // What the step needs now stands out.
    const next = state.task.to_go?.gripper ?? null;
    for (const what of /** @type {("open" | "close")[]} */ (["open", "close"])) buttons[what].dataset.next = String(what === next);
    const words = gripperWords(state.gripper, most);
    if (words === wanted) return;
    wanted = words;
    clearTimeout(timer);
    timer = setTimeout(() => setText(byId("gripper-state"), wanted), SETTLE_MS);
  });

  return {
    /** The other way than it was last told, by a key or a gamepad's button; held, it opens while the arm is not enabled. @param {Source} source */
    toggle(source) {
      if (widest() === null || !hold(source)) ask("toggle", source);
    },
    /** Its place among the choices of a switch, which says what it will do. @returns {Choice[]} */
    choices() {
      const [{ state }, most] = [connection, widest()];
      if (!state?.gripper || most === null) return [];
      // Where it is closed or on its way, the next thing to do is to open it.
      const { width_m, holding, closing } = state.gripper;
      const closed = closing ?? (holding || width_m < most / 2);
      return [{
        id: "gripper",
        label: say(closed ? "gripper.open" : "gripper.close"),
        act: () => ask(closed ? "open" : "close", "switch"),
      }];
    },
  };
}
