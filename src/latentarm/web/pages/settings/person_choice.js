/** Who sits here, in the dialog of the settings: one of the people whom the server knows, or a guest. */

import { create } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { ask } from "../records/ask.js";

/** @param {HTMLSelectElement} select @param {Settings} settings */
export function attachPersonChoice(select, settings) {
  /** Those who have a PIN, which the People page asks for. @type {Set<string>} */
  let pinned = new Set();
  /** @param {{id: string, name: string, pin?: boolean}[]} people */
  const fill = (people) => {
    pinned = new Set(people.filter(({ pin }) => pin).map(({ id }) => id));
    const guest = create("option", { value: "", textContent: say("settings.guest") });
    select.replaceChildren(guest, ...people.map(({ id, name }) => create("option", { value: id, textContent: name })));
    select.value = settings.person?.id ?? "";
  };
  select.addEventListener("change", () => {
    const [chosen] = select.selectedOptions;
    if (pinned.has(chosen.value)) location.assign(`/people#${chosen.value}`);
    else settings.become(chosen.value ? { id: chosen.value, name: chosen.text } : null);
  });
  return async () => {
    fill(settings.person ? [settings.person] : []);
    const found = await ask("GET", "/records/people").catch(() => null);
    if (found) fill(found.people);
  };
}
