/** Which way of pressing is shown: the stick, the buttons or the switch. */

import { byId, whenever } from "../layout/dom.js";

/** The switch shows itself. */
const PANELS = ["stick", "dpad"];

/** Where another way is chosen, what is pressed is let go. @param {PersonInput} input @param {Settings} settings */
export function attachInputChoice(input, settings) {
  const radios = /** @type {NodeListOf<HTMLInputElement>} */ (document.querySelectorAll("input[name=panel]"));
  let shown = settings.values.panel;

  const show = () => {
    const { panel } = settings.values;
    for (const name of PANELS) byId(`panel-${name}`).hidden = name !== panel;
    for (const radio of radios) radio.checked = radio.value === panel;
    // Last: at a halt the switches look for their place, which must be free.
    if (panel !== shown) input.halt("input_changed");
    shown = panel;
  };
  for (const radio of radios) {
    radio.addEventListener("change", () => settings.change({ panel: /** @type {Values["panel"]} */ (radio.value) }));
  }
  whenever(settings, ["change"], show);
}
