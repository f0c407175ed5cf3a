/** The panel of the guided practice: offered to a person who is new, shown step by step, and gone when they skip it. */

import { linkChoices } from "../inputs/scan_choices.js";
import { byId, create, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { Practice, STEPS } from "./steps.js";

/** @param {Connection} connection @param {DriveInput} input @param {Settings} settings */
export function attachPractice(connection, input, settings) {
  const panel = byId("practice");
  const list = byId("practice-steps");
  /** @type {Practice | null} */
  let practice = null;
  // A study has practice of its own.
  const offered = () => !settings.values.practised && !document.documentElement.hasAttribute("data-fixed");
  let open = offered();

  const show = () => {
    panel.hidden = !open;
    const running = practice !== null && practice.step !== null;
    const finished = practice !== null && practice.step === null;
    setText(byId("practice-title"), say(finished ? "practice.finished" : running ? "practice.title" : "practice.offer"));
    byId("practice-begin").hidden = practice !== null;
    byId("practice-again").hidden = practice === null;
    document.getElementById("practice-fit")?.toggleAttribute("hidden", practice !== null || Object.keys(settings.values.fit).length > 0);
    setText(byId("practice-skip"), say(finished ? "practice.close" : "practice.skip"));
    list.hidden = !running;
    if (practice === null) return;
    const { done } = practice;
    list.replaceChildren(...STEPS.map((name, index) => {
      const step = say(`practice.short_${name}`);
      const state = { ...(index < done && { ariaLabel: say("practice.done", { step }) }), ...(index === done && { ariaCurrent: "step" }) };
      return create("li", { textContent: step, ...state, dataset: { done: String(index < done) } });
    }));
  };
  const become = (/** @type {Practice | null} */ now) => {
    practice = now;
    open = now !== null;
    settings.change({ practised: true });
    show();
  };
  const begin = () => become(new Practice());
  const close = () => become(null);

  byId("practice-begin").addEventListener("click", begin);
  byId("practice-again").addEventListener("click", begin);
  byId("practice-open").addEventListener("click", () => {
    byId("settings", HTMLDialogElement).close();
    begin();
  });
  byId("practice-skip").addEventListener("click", close);
  settings.addEventListener("change", () => {
    // Somebody else may sit here now.
    if (practice === null) open = offered();
    show();
  });
  connection.addEventListener("state", () => {
    const { state, welcome, driving, engaged } = connection;
    if (practice === null || state === null || welcome === null) return;
    const seen = {
      engaged: driving && engaged,
      moving: state.phase === "moving",
      pressed: input.source !== null,
      tool: state.tool,
      goals: welcome.goals.map(({ position }) => position),
    };
    if (practice.see(seen)) show();
  });
  show();

  return {
    /** The step to do; null where nobody practises. */
    get step() {
      return practice?.step ?? null;
    },
    stopped() {
      if (connection.driving && connection.engaged && practice?.stopped()) show();
    },
    /** A switch's choices in it. @returns {Choice[]} */
    choices() {
      if (!open) return [];
      const first = practice === null ? { id: "practice-begin", label: say("practice.begin"), act: begin }
        : { id: "practice-again", label: say("practice.again"), act: begin };
      return [first, ...linkChoices(panel), { id: "practice-skip", label: byId("practice-skip").textContent ?? "", act: close }];
    },
  };
}
