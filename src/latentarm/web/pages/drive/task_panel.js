/** The task: its steps tick off, its end is said and heard, and another run is begun. */

import { byId, create, setDisabled, setText } from "../layout/dom.js";
import { thingWords } from "../layout/thing_words.js";
import { say } from "../layout/words.js";
import { awayWords, blockedWords, fillWords, outcomeWords, stepNow, stepWords, stuck, stuckWords } from "./task_words.js";

/** @import {Fill, TaskState} from "../connection/messages.js" */

/** Words that change all the time change no more often than this, ms. */
const WORDS_MS = 250;

/** @param {Connection} connection @param {(outcome: "success" | "failure") => void} ended when a run ends while this page looks on @returns {() => Choice[]} choices for people who press one switch */
export function attachTask(connection, ended) {
  const [panel, steps, levels, said] = ["task", "task-steps", "task-fills", "task-said"].map((id) => byId(id));
  const [nextRun, sameRun, choice] = [byId("task-next"), byId("task-again"), byId("task-choice", HTMLSelectElement)];
  /** @type {TaskState | null} */
  let before = null;
  let wordsAt = -Infinity;
  /** Whether this page was there when a run began, which counts its time, and when the arm was driven in it. */
  let [began, there] = [false, false];

  const blocked = () => (connection.state ? blockedWords(connection.state) : say("status.connecting"));
  const begin = (/** @type {{choice: number | null, anew: boolean}} */ what) => {
    if (blocked()) return;
    connection.send({ type: "begin_run", ...what });
    // Enter would begin yet another one.
    if (document.activeElement === nextRun || document.activeElement === sameRun) byId("enable").focus({ preventScroll: true });
  };
  const next = () => {
    const { state, welcome } = connection;
    if (state && welcome) begin({ choice: (state.task.choice + 1) % welcome.task.choices.length, anew: true });
  };
  const again = () => begin({ choice: null, anew: false });
  nextRun.addEventListener("click", next);
  sameRun.addEventListener("click", again);
  choice.addEventListener("change", () => {
    begin({ choice: Number(choice.value), anew: false });
    choice.value = String(connection.state?.task.choice ?? 0);
  });

  connection.addEventListener("welcome", () => {
    const { task } = /** @type {Welcome} */ (connection.welcome);
    panel.hidden = task.steps.length === 0;
    steps.replaceChildren(...task.steps.map((step) => {
      const spoken = create("span", { className: "visually-hidden" });
      return create("li", {}, create("span", { textContent: stepWords(step) }), spoken, create("span", { className: "step-away" }));
    }));
    byId("task-chooser").hidden = task.choices.length < 2;
    choice.replaceChildren(...task.choices.map((name, index) =>
      create("option", { value: String(index), textContent: thingWords(name), selected: index === task.choice })));
    before = null;
    wordsAt = -Infinity;
    setText(said, "");
  });

  const showSteps = (/** @type {TaskState} */ task) => {
    const now = task.outcome === null ? stepNow(task) : -1;
    [...steps.children].forEach((item, index) => {
      const state = index === now ? "now" : index < task.done ? "done" : "later";
      const step = /** @type {HTMLElement} */ (item);
      if (step.dataset.step === state) return;
      step.dataset.step = state;
      if (state === "now") step.setAttribute("aria-current", "step");
      else step.removeAttribute("aria-current");
      setText(step.children[1], say("task.step_state", { state: say(`task.state.${state}`) }));
    });
  };

  const showFills = (/** @type {Fill[]} */ fills) => {
    levels.hidden = fills.length === 0;
    if (levels.children.length !== fills.length) levels.replaceChildren(...fills.map(() => create("li")));
    fills.forEach((fill, index) => setText(levels.children[index], fillWords(fill)));
  };

  connection.addEventListener("state", () => {
    const { state, welcome } = connection;
    if (!state || !welcome?.task.steps.length) return;
    const { task } = state;
    // A welcome announces a new run first.
    if (task.choice !== welcome.task.choice) return;
    began ||= task.time_s === 0;
    there ||= began || connection.engaged;
    showSteps(task);
    panel.dataset.outcome = task.outcome ?? (stuck(task) ? "stuck" : "");
    if (task.outcome !== null) setText(said, there ? outcomeWords(task) : say("task.over"));
    else if (stuck(task)) setText(said, stuckWords(task));
    else if (before !== null && (before.lost || task.done > before.done)) {
      const step = stepWords(welcome.task.steps[task.done]);
      const number = before.lost ? before.lost.step + 1 : task.done;
      setText(said, say("task.step_done", { number, all: welcome.task.steps.length, step }));
    } else if (task.done === 0) setText(said, "");
    if (before !== null && before.outcome === null && task.outcome !== null) ended(task.outcome);
    const over = task.outcome !== null || stuck(task);
    if (over !== (before !== null && (before.outcome !== null || stuck(before)))) byId("task-more", HTMLDetailsElement).open = over;
    // The remaining way of the current step is announced at once.
    if (before === null || stepNow(task) !== stepNow(before)) wordsAt = -Infinity;
    before = task;
    const why = blocked();
    setText(byId("task-why"), why);
    for (const button of [nextRun, sameRun]) setDisabled(button, why !== "");
    choice.disabled = why !== "";
    if (performance.now() - wordsAt < WORDS_MS) return;
    wordsAt = performance.now();
    setText(byId("task-time"), began ? say("task.time", { seconds: Math.round(task.time_s) }) : "");
    const away = awayWords(state);
    [...steps.children].forEach((item, index) => setText(item.children[2], index === stepNow(task) ? away : ""));
    showFills(task.fills);
  });

  return () => {
    const { state, welcome } = connection;
    if (!state || !welcome?.task.steps.length || blocked()) return [];
    const go = { id: "next", label: say("task.next"), act: next };
    return state.task.outcome === null && !stuck(state.task) ? [go] : [go, { id: "again", label: say("task.again"), act: again }];
  };
}
