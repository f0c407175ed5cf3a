/** The dialog that asks for a PIN, or for a new one: by the keyboard, or by its own digits. */

import { byId, setText } from "../layout/dom.js";
import { say } from "../layout/words.js";
import { ask, attempt, showProblem } from "../records/ask.js";

/** @typedef {{id: string, name: string, pin: boolean}} Pinned */

export function attachPinDialog() {
  const dialog = byId("pin", HTMLDialogElement);
  const field = byId("pin-digits", HTMLInputElement);
  /** Takes the digits. @type {(pin: string) => Promise<void>} */
  let take = async () => {};

  /** @param {string} title @param {string} help @param {"text" | "password"} type @param {(pin: string) => Promise<void>} then */
  const open = (title, help, type, then) => {
    setText(byId("pin-title"), title);
    setText(byId("pin-help"), help);
    showProblem("", "pin-problem");
    field.type = type;
    field.value = "";
    take = then;
    dialog.showModal();
    field.focus();
  };

  for (const key of /** @type {NodeListOf<HTMLElement>} */ (dialog.querySelectorAll("[data-digit]"))) {
    key.addEventListener("click", () => {
      if (field.value.length < field.maxLength) field.value += key.dataset.digit;
    });
  }
  byId("pin-delete").addEventListener("click", () => {
    field.value = field.value.slice(0, -1);
  });
  dialog.addEventListener("close", () => {
    field.value = "";
  });
  dialog.querySelector("form")?.addEventListener("submit", async (event) => {
    event.preventDefault();
    await attempt(async () => {
      const pin = field.value;
      field.value = "";
      await take(pin);
      dialog.close();
    }, "pin-problem");
  });

  return {
    /** Do something with a person's record, once it is open. @param {Pinned | null} person @param {() => void} act */
    async opened(person, act) {
      // This browser may have opened it before.
      const isOpen = !person?.pin || await ask("GET", `/records/people/${person.id}`).then(() => true, () => false);
      if (isOpen) act();
      else open(say("pin.title", { name: person.name }), say("pin.help"), "password", async (pin) => {
        await ask("POST", `/records/people/${person.id}/unlock`, { pin });
        act();
      });
    },
    /** Give a record a PIN. It is seen while it is typed: nobody can read it later. @param {Pinned} person @param {() => void} then */
    choose(person, then) {
      open(say("pin.new_title", { name: person.name }), say("pin.new_help"), "text", async (pin) => {
        await ask("PUT", `/records/people/${person.id}/pin`, { pin });
        then();
      });
    },
  };
}
