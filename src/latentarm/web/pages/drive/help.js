/** How much the robot helps: the person chooses a level, which is kept with their settings. */

import { byId, checkRadio, setHidden, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";

/** The effect of the current level. @param {Pick<State, "mode" | "help">} state */
export function helpWords({ mode, help }) {
  if (help === null) return "";
  return say(mode === "end_effector" ? "help.not_here" : `help.${help}_does`);
}

/** Asks for the person's level once they drive, and again whenever they choose another one. @param {Connection} connection @param {Settings} settings */
export function attachHelp(connection, settings) {
  const fieldset = byId("help");
  /** @type {Values["help"] | null} What was asked for since this page drives. */
  let asked = null;

  const ask = () => {
    const { state } = connection;
    if (!connection.driving || state === null) {
      asked = null;
      return;
    }
    const wanted = settings.values.help;
    if (state.help === null || wanted === asked) return;
    asked = wanted;
    if (wanted !== state.help) connection.send({ type: "help", level: wanted });
  };
  const choose = (/** @type {Values["help"]} */ help) => {
    // The same level again, where another page or the server has changed it since.
    asked = null;
    settings.change({ help });
  };
  const show = () => {
    const { state } = connection;
    if (!state) return;
    setHidden(fieldset, state.help === null);
    checkRadio(fieldset, state.you ? settings.values.help : state.help, state.you);
    setText(byId("help-text"), helpWords(state));
  };
  const follow = () => {
    ask();
    show();
  };
  fieldset.addEventListener("change", ({ target }) => choose(/** @type {Values["help"]} */ (/** @type {HTMLInputElement} */ (target).value)));
  connection.addEventListener("welcome", () => {
    asked = null;
  });
  connection.addEventListener("state", follow);
  settings.addEventListener("change", follow);
}
