/** The task: its steps tick off, its end is said and heard, and another run is begun. */

import { create, setDisabled, setText } from "../layout/dom.js";
import { thingWords } from "../layout/thing_words.js";
import { say } from "../layout/words.js";
import { awayWords, blockedWords, fillWords, outcomeWords, stepNow, stepWords, stuck, stuckWords, wholeSeconds } from "./task_words.js";

/** @import {Connection} from "../connection/connection.js" */
/** @import {Fill, TaskState} from "../connection/messages.js" */
/** @import {Choice} from "../inputs/scanner.js" */

/** Words that change all the time change no more often than this, ms. */
const WORDS_MS = 250;

/**
 * `said` is live: steps as they are done, why they cannot be done, and the end. `more` has what another run is begun with, and
 * `then` the focus once it was begun. `why` says why nothing can be begun now.
 *
 * @typedef {Record<"panel" | "steps" | "fills" | "said" | "time" | "why" | "chooser" | "next" | "again" | "then", HTMLElement>
 *   & {more: HTMLDetailsElement, choice: HTMLSelectElement}} Parts
 */

/**
 * @param {Parts} parts
 * @param {Connection} connection
 * @param {(outcome: "success" | "failure") => void} ended when a run ends while this page looks on
 */
export function attachTask(parts, connection, ended) {
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
    if (document.activeElement === parts.next || document.activeElement === parts.again) parts.then.focus({ preventScroll: true });
  };
  const next = () => {
    const { state, welcome } = connection;
    if (state && welcome) begin({ choice: (state.task.choice + 1) % welcome.task.choices.length, anew: true });
  };
  const again = () => begin({ choice: null, anew: false });
  parts.next.addEventListener("click", next);
  parts.again.addEventListener("click", again);
  parts.choice.addEventListener("change", () => {
    begin({ choice: Number(parts.choice.value), anew: false });
    parts.choice.value = String(connection.state?.task.choice ?? 0);
  });

  connection.addEventListener("welcome", () => {
    const { task } = /** @type {NonNullable<Connection["welcome"]>} */ (connection.welcome);
    parts.panel.hidden = task.steps.length === 0;
    parts.steps.replaceChildren(...task.steps.map((step) => {
      const spoken = create("span", { className: "visually-hidden" });
      return create("li", {}, create("span", { textContent: stepWords(step) }), spoken, create("span", { className: "step-away" }));
    }));
    parts.chooser.hidden = task.choices.length < 2;
    parts.choice.replaceChildren(...task.choices.map((name, index) =>
      create("option", { value: String(index), textContent: thingWords(name), selected: index === task.choice })));
    before = null;
    wordsAt = -Infinity;
    setText(parts.said, "");
  });

  const showSteps = (/** @type {TaskState} */ task) => {
    const now = task.outcome === null ? stepNow(task) : -1;
    [...parts.steps.children].forEach((item, index) => {
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
    parts.fills.hidden = fills.length === 0;
    if (parts.fills.children.length !== fills.length) parts.fills.replaceChildren(...fills.map(() => create("li")));
    fills.forEach((fill, index) => setText(parts.fills.children[index], fillWords(fill)));
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
    parts.panel.dataset.outcome = task.outcome ?? (stuck(task) ? "stuck" : "");
    if (task.outcome !== null) setText(parts.said, there ? outcomeWords(task) : say("task.over"));
    else if (stuck(task)) setText(parts.said, stuckWords(task));
    else if (before !== null && (before.lost || task.done > before.done)) {
      const step = stepWords(welcome.task.steps[task.done]);
      const number = before.lost ? before.lost.step + 1 : task.done;
      setText(parts.said, say("task.step_done", { number, all: welcome.task.steps.length, step }));
    } else if (task.done === 0) setText(parts.said, "");
    if (before !== null && before.outcome === null && task.outcome !== null) ended(task.outcome);
    const over = task.outcome !== null || stuck(task);
    if (over !== (before !== null && (before.outcome !== null || stuck(before)))) parts.more.open = over;
    // The remaining way of the current step is announced at once.
    if (before === null || stepNow(task) !== stepNow(before)) wordsAt = -Infinity;
    before = task;
    const why = blocked();
    setText(parts.why, why);
    for (const button of [parts.next, parts.again]) setDisabled(button, why !== "");
    parts.choice.disabled = why !== "";
    if (performance.now() - wordsAt < WORDS_MS) return;
    wordsAt = performance.now();
    setText(parts.time, began ? say("task.time", { seconds: wholeSeconds(task.time_s) }) : "");
    const away = awayWords(state);
    [...parts.steps.children].forEach((item, index) => setText(item.children[2], index === stepNow(task) ? away : ""));
    showFills(task.fills);
  });

  return {
    /** Choices for people who press one switch. @returns {Choice[]} */
    choices() {
      const { state, welcome } = connection;
      if (!state || !welcome?.task.steps.length || blocked()) return [];
      const go = { id: "next", label: say("task.next"), act: next };
      return state.task.outcome === null && !stuck(state.task) ? [go] : [go, { id: "again", label: say("task.again"), act: again }];
    },
  };
}
