/** The card to print: how to move, Enable and Stop, for the input that the person has chosen. */

import { isSwitch } from "../inputs/keys.js";
import { byId, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { stepKey } from "../practice/step_words.js";

/** @import {Step} from "../practice/steps.js" */

/** @param {Connection} connection @param {Settings} settings */
export function attachCard(connection, settings) {
  const show = () => {
    setText(byId("card-person"), settings.name);
    byId("card-gripper").hidden = typeof connection.welcome?.gripper_width_m !== "number" || settings.values.panel === "switch";
    for (const line of /** @type {NodeListOf<HTMLElement>} */ (byId("card").querySelectorAll("[data-card]"))) {
      setText(line, say(stepKey(/** @type {Exclude<Step, "watch" | "reach">} */ (line.dataset.card), settings.values)));
    }
    // Where Space is a switch, it does not stop.
    setText(byId("card-keys"), say(isSwitch(settings.values, "Space") ? "card.stop_escape" : "card.stop_keys"));
  };
  byId("card-print").addEventListener("click", () => print());
  connection.addEventListener("welcome", show);
  whenever(settings, ["change"], show);
}
