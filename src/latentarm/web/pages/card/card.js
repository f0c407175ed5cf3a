/** The card to print: how to move, Enable and Stop, for the input that the person has chosen. */

import { byId, setText } from "../layout/dom.js";
import { stepWords } from "../practice/step_words.js";

/** @import {Connection} from "../connection/connection.js" */
/** @import {Settings} from "../settings/settings.js" */
/** @import {Step} from "../practice/steps.js" */

/** @param {Connection} connection @param {Settings} settings */
export function attachCard(connection, settings) {
  const show = () => {
    setText(byId("card-person"), settings.name);
    byId("card-gripper").hidden = typeof connection.welcome?.gripper_width_m !== "number" || settings.values.panel === "switch";
    for (const line of /** @type {NodeListOf<HTMLElement>} */ (byId("card").querySelectorAll("[data-card]"))) {
      setText(line, stepWords(/** @type {Step} */ (line.dataset.card), settings.values, false));
    }
  };
  byId("card-print").addEventListener("click", () => print());
  settings.addEventListener("change", show);
  connection.addEventListener("welcome", show);
  show();
}
