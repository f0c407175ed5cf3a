/**
 * Points that a person confirms before a real arm is enabled for the first time, and after its connection was lost. The
 * server enables nothing before it has heard of it.
 */

import { byId, create } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** @param {Connection} connection */
export function attachChecklist(connection) {
  const boxes = ["stop", "area", "payload"].map((id) => byId(`checklist-${id}`, HTMLInputElement));
  const done = () => !connection.welcome?.real || boxes.every((box) => box.checked);
  let lost = false;
  /** Which start of the arm the boxes are about. */
  let start = 0;
  /** True until this connection has told the server what was confirmed. */
  let untold = true;
  const tell = () => {
    if (connection.welcome?.real && done()) connection.send({ type: "confirm", arm_start: start, stop: true, area: true, payload: true });
  };
  const show = () => {
    const real = connection.welcome?.real ?? null;
    // An arm that is not connected is connected first.
    byId("checklist").hidden = done() || lost;
    byId("checklist-facts").replaceChildren(...(real?.facts ?? []).flatMap(([name, value]) => [create("dt", { textContent: name }), create("dd", { textContent: value })]));
  };
  for (const box of boxes) {
    box.addEventListener("change", () => {
      show();
      tell();
    });
  }
  const uncheck = () => {
    for (const box of boxes) box.checked = false;
  };
  connection.addEventListener("server_changed", uncheck);
  connection.addEventListener("welcome", () => {
    untold = true;
    show();
  });
  connection.addEventListener("state", () => {
    if (!connection.state) return;
    const { arm_start: now, lost: isLost } = connection.state;
    // It may have been switched off, moved, or given something else to carry.
    if (now !== start) uncheck();
    const changed = now !== start || isLost !== lost;
    [start, lost] = [now, isLost];
    if (changed) show();
    if (untold) tell();
    untold = false;
  });
  show();

  return {
    done,
    refuse() {
      boxes.find((box) => !box.checked)?.focus();
    },
    /** The points that are left to confirm, for a switch. @returns {Choice[]} */
    choices() {
      if (done()) return [];
      return boxes.filter((box) => !box.checked).map((box) => ({ id: box.id, label: box.labels?.[0]?.textContent?.trim() ?? box.id, act: () => box.click() }));
    },
  };
}
