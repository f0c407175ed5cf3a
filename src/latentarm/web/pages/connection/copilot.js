/** A co-pilot: a watcher who may slow or stop the arm, once the driver has said yes. */

import { byId, setHidden, setText } from "../layout/dom.js";
import { say, sayName, sayPercent } from "../layout/words.js";

/** How often the co-pilot's page says how fast the arm may be, ms; the arm stops where it does not. */
const PERIOD_MS = 100;

/** A sentence about the co-pilot for this page's person. @param {State} state @param {string} me id of this page */
export function copilotWords({ you, driver, copilot, copilot_asking }, me) {
  if (copilot !== null) {
    const parameters = { name: sayName(copilot.name), pace: sayPercent(copilot.pace) };
    if (copilot.id === me) return say("copilot.is_me");
    return say(you ? "copilot.is_yours" : "copilot.is", parameters);
  }
  if (copilot_asking !== null) {
    if (copilot_asking.id === me) return say("copilot.asked");
    return say(you ? "copilot.asks_you" : "copilot.asks", { name: sayName(copilot_asking.name) });
  }
  return say(you || driver === null ? "copilot.none" : "copilot.could");
}

/** @param {Connection} connection */
export function attachCopilot(connection) {
  const slider = byId("copilot-slider", HTMLInputElement);
  const [ask, accept, end] = ["copilot-ask", "copilot-accept", "copilot-end"].map((id) => byId(id, HTMLButtonElement));
  let pace = 1;
  let was = false;

  const choose = (/** @type {number} */ percent) => {
    pace = percent / 100;
    slider.value = String(percent);
    setText(byId("copilot-pace-text"), sayPercent(pace));
    tell();
  };
  const tell = () => {
    const { state } = connection;
    if (was && state && connection.fresh) connection.send({ type: "copilot_pace", pace, nonce: state.nonce });
  };
  ask.addEventListener("click", () => connection.send({ type: "ask_to_copilot" }));
  end.addEventListener("click", () => connection.send({ type: "end_copilot" }));
  accept.addEventListener("click", () => {
    const to = connection.state?.copilot_asking?.id;
    if (to) connection.send({ type: "accept_copilot", to });
  });
  slider.addEventListener("input", () => choose(Number(slider.value)));
  for (const button of /** @type {NodeListOf<HTMLElement>} */ (byId("copilot-pace").querySelectorAll("[data-pace]"))) {
    button.addEventListener("click", () => choose(Number(button.dataset.pace)));
  }
  setInterval(tell, PERIOD_MS);

  connection.addEventListener("state", () => {
    const { state, welcome } = connection;
    if (!state || !welcome) return;
    const { you, driver, copilot, copilot_asking } = state;
    const [isMe, askedHere] = [copilot?.id === welcome.id, copilot_asking?.id === welcome.id];
    const begins = isMe && !was;
    was = isMe;
    // A new co-pilot slows nobody down yet.
    if (begins) choose(100);
    setHidden(ask, you || driver === null || copilot !== null || copilot_asking !== null);
    setHidden(accept, !you || copilot_asking === null);
    if (copilot_asking) setText(accept, say("copilot.accept", { name: sayName(copilot_asking.name) }));
    setHidden(end, !(isMe || askedHere || (you && (copilot !== null || copilot_asking !== null))));
    setText(end, say(copilot === null ? (you ? "copilot.refuse" : "copilot.withdraw") : "copilot.end"));
    setHidden(byId("copilot-pace"), !isMe);
    setHidden(byId("copilot"), copilot === null && copilot_asking === null);
    setText(byId("copilot"), copilotWords(state, welcome.id));
  });
}
