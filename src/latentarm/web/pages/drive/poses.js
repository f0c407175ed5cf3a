/** Poses, the robot's own and saved ones: a button for each drives the arm there; where it stands can be saved as another one. */

import { byId, create, createButton, setDisabled, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { sayTo } from "../connection/notices.js";

/** @typedef {Welcome["poses"][number]} BuiltInPose */

/** Why the arm cannot go to a pose now, or "help" where it can. @param {Pick<Connection, "driving" | "engaged" | "state">} connection */
export function goingOf({ driving, engaged, state }) {
  if (!driving || state === null) return "driver_only";
  if (state.returning) return "on";
  if (!engaged) return "enable_first";
  return state.phase === "moving" || state.let_go_first ? "let_go" : "help";
}

/** @param {Pick<Connection, "driving" | "state">} connection whether where the arm stands can be saved now */
export function savesOf({ driving, state }) {
  return driving && state !== null && state.phase !== "moving" && state.phase !== "stopping";
}

/** @param {Connection} connection @returns {() => Choice[]} all of them among the choices of a switch, where the arm can go to them */
export function attachPoses(connection) {
  const [poses, field] = [byId("poses"), byId("pose-name", HTMLInputElement)];
  const go = (/** @type {string} */ name, /** @type {BuiltInPose | null} */ built_in) => {
    if (goingOf(connection) !== "help") return;
    connection.send({ type: "to_pose", name, built_in });
    byId("poses-panel").hidePopover();
  };
  /** Where the arm can go: what it is called, and which one of the robot's own it is. @returns {[string, BuiltInPose | null][]} */
  const all = () => [
    ...(connection.welcome?.poses ?? []).map((own) => /** @type {[string, BuiltInPose]} */ ([say(`poses.${own}`), own])),
    ...(connection.poses?.names ?? []).map((name) => /** @type {[string, null]} */ ([name, null])),
  ];
  const save = () => {
    const name = field.value.trim();
    if (name === "") field.focus();
    else if (savesOf(connection)) {
      connection.send({ type: "save_pose", name });
      field.value = "";
    }
  };
  const show = () => {
    const why = goingOf(connection);
    const problem = connection.poses?.problem ?? null;
    setText(byId("poses-why"), problem === null ? say(`poses.${why}`) : sayTo(problem, { you: true, own: connection.own, late: null, absent: false }));
    for (const button of poses.querySelectorAll("[data-go]")) setDisabled(button, why !== "help");
    for (const button of poses.querySelectorAll("[data-delete]")) setDisabled(button, !connection.driving);
    setDisabled(byId("pose-save"), !savesOf(connection));
  };
  const list = () => {
    const rows = all().map(([name, own]) => {
      const there = createButton(say("poses.go", { pose: name }), () => go(name, own), { dataset: { go: name } });
      const forget = createButton("×", () => {
        if (connection.driving) connection.send({ type: "delete_pose", name });
      }, { className: "quiet", ariaLabel: say("poses.delete", { pose: name }), dataset: { delete: name } });
      return create("li", { className: "row" }, there, ...(own === null ? [forget] : []));
    });
    poses.replaceChildren(...rows);
    show();
  };
  byId("pose-save").addEventListener("click", save);
  whenever(connection, ["poses", "welcome"], list);
  whenever(connection, ["state", "open"], show);

  return () => {
    if (goingOf(connection) !== "help") return [];
    return all().map(([name, own]) => ({ id: `pose-${own ?? "saved"}-${name}`, label: say("poses.go", { pose: name }), act: () => go(name, own) }));
  };
}
