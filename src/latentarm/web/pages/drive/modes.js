/** The stick's modes: latent actions, with help or without, or the tool along two axes at a time; and its speed. */

import { byId, checkRadio, create, setHidden, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** @typedef {Exclude<State["mode"], "assisted">} ModeName with help or without is chosen apart */
/** @typedef {{mode: ModeName, axes: number}} Steering a mode, and which pair of the end-effector's axes */

/** How long the server may take to change the mode, ms. */
const ANSWER_MS = 300;

/** The next mode, for people with one button: the pairs of axes too, before the next mode. @param {Welcome} welcome @param {State} state @returns {Steering} */
export function nextSteering(welcome, { mode, axes }) {
  const modes = steeringModes(welcome);
  if (mode === "end_effector" && axes + 1 < welcome.end_effector_modes.length) return { mode, axes: axes + 1 };
  return { mode: modes[(modes.indexOf(withoutHelp(mode)) + 1) % modes.length], axes: 0 };
}

/** @param {Pick<Welcome, "modes">} welcome @returns {ModeName[]} */
function steeringModes({ modes }) {
  return /** @type {ModeName[]} */ (modes.filter((mode) => mode !== "assisted"));
}

/** @param {State["mode"]} mode @returns {ModeName} */
function withoutHelp(mode) {
  return mode === "assisted" ? "latent" : mode;
}

/** @param {Connection} connection @param {Settings} settings */
export function attachModes(connection, settings) {
  let askedAt = -Infinity;

  const ask = (/** @type {Steering} */ { mode, axes }) => {
    askedAt = performance.now();
    const helped = settings.values.help !== "off" && connection.welcome?.modes.includes("assisted");
    if (mode === "end_effector") connection.send({ type: "mode", mode, axes });
    else connection.send({ type: "mode", mode: helped ? "assisted" : mode });
  };
  connection.addEventListener("welcome", () => {
    if (!connection.welcome) return;
    const { end_effector_modes } = connection.welcome;
    const modes = steeringModes(connection.welcome);
    fill(byId("mode"), "mode", modes.map((mode) => say(`modes.${mode}`)), (index) => ask({ mode: modes[index], axes: 0 }));
    // Where there is one alone, nothing is chosen.
    setHidden(byId("mode"), modes.length < 2);
    const axes = end_effector_modes.map((name) => say(/** @type {WordKey} */ (`axes.${name}`)));
    fill(byId("axes"), "axes", axes, (index) => ask({ mode: "end_effector", axes: index }));
  });
  connection.addEventListener("state", () => {
    const { state, welcome } = connection;
    // A new choice stays until the server has had time to say otherwise.
    if (!state || performance.now() - askedAt < ANSWER_MS) return;
    // The server's choice is shown, not the click.
    checkRadio(byId("mode"), welcome ? steeringModes(welcome).indexOf(withoutHelp(state.mode)) : -1, state.you);
    checkRadio(byId("axes"), state.axes, state.you);
    setHidden(byId("axes"), state.mode !== "end_effector");
  });

  return {
    next() {
      const { state, welcome } = connection;
      if (state && welcome?.modes.length) ask(nextSteering(welcome, state));
    },
    /** @param {number} index */
    axes(index) {
      if (index < (connection.welcome?.end_effector_modes.length ?? 0)) ask({ mode: "end_effector", axes: index });
    },
  };
}

/** Slow, medium and fast, as shares of the full speed; the setting may also lie between them. @param {Settings} settings */
export function attachSpeed(settings) {
  const fieldset = byId("speed");
  const radios = fieldset.querySelectorAll("input");
  const show = () => radios.forEach((radio) => (radio.checked = Number(radio.value) === settings.values.sensitivity));
  fieldset.addEventListener("change", ({ target }) => settings.change({ sensitivity: Number(/** @type {HTMLInputElement} */ (target).value) }));
  whenever(settings, ["change"], show);
}

/** @param {HTMLElement} fieldset @param {string} name @param {string[]} labels @param {(index: number) => void} chosen */
function fill(fieldset, name, labels, chosen) {
  const options = labels.map((textContent, index) => {
    const input = create("input", { type: "radio", name, value: String(index) });
    input.addEventListener("change", () => chosen(index));
    return create("label", {}, input, create("span", { textContent }));
  });
  fieldset.querySelector(".options")?.replaceChildren(...options);
}
