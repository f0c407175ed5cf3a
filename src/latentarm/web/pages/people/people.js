/** The People page: who drives, adding, renaming, taking along, bringing and deleting. */

import { attachWholePage } from "../inputs/whole_page.js";
import { byId, create, createButton, setText } from "../layout/dom.js";
import { attachPage } from "../layout/page.js";
import { say, sayNotice } from "../layout/words.js";
import { ask, attempt, sayTime, showProblem } from "../records/ask.js";
import { attachPinDialog } from "./pin_dialog.js";

/** @typedef {{id: string, name: string, pin: boolean, drives: number, last: string | null}} Person */

const { settings, stop } = attachPage();
attachWholePage(settings, stop);
const add = byId("add", HTMLFormElement);
const nameField = /** @type {HTMLInputElement} */ (add.elements.namedItem("person"));
const renaming = byId("rename", HTMLDialogElement);
const newName = /** @type {HTMLInputElement} */ (renaming.querySelector("input"));
const erasing = byId("erase", HTMLDialogElement);
const file = byId("import-file", HTMLInputElement);

const pin = attachPinDialog();

/** The person whom the open dialog is about. @type {Person | null} */
let about = null;
let pins = false;
/** The person whom another page led here to choose, until they were looked for. */
let asked = location.hash.slice(1);

/** @param {Person | null} person null for a guest */
function choose(person) {
  settings.become(person && { id: person.id, name: person.name });
  setText(byId("told"), say("people.now", { name: person?.name ?? say("settings.guest") }));
}

async function refresh() {
  const found = await ask("GET", "/records/people");
  const { people, problems } = found;
  pins = found.pins;
  const row = document.activeElement?.closest("li")?.dataset.person;
  byId("people").replaceChildren(rowOf(null), ...people.map(rowOf));
  if (row !== undefined) /** @type {HTMLElement | null} */ (byId("people").querySelector(`[data-person="${row}"] button`))?.focus();
  const wanted = /** @type {Person[]} */ (people).find(({ id }) => id === asked);
  asked = "";
  if (wanted) pin.opened(wanted, () => choose(wanted));
  if (problems.length) showProblem(problems.map(sayNotice).join(" "));
}

/** @param {Person | null} person null for a guest @returns {HTMLElement} */
function rowOf(person) {
  const here = (settings.person?.id ?? null) === (person?.id ?? null);
  const called = person?.name ?? say("settings.guest");
  const name = create("span", { className: "person-name" }, create("bdi", { textContent: called }), create("small", { textContent: person ? driven(person) : say("people.guest_help") }));
  const tools = create("div", { className: "row" }, button("people.choose", person, () => pin.opened(person, () => choose(person)), here));
  if (person) {
    tools.append(
      button("people.rename", person, () => pin.opened(person, () => openRename(person))),
      exportLink(person),
      button("people.erase", person, () => pin.opened(person, () => openErase(person))),
    );
    if (pins) tools.append(person.pin ? button("people.pin_remove", person, () => removePin(person)) : button("people.pin_set", person, () => setPin(person)));
  }
  // Its label is the row's name for a switch.
  return create("li", { ariaLabel: called, dataset: { person: person?.id ?? "", here: String(here) } }, name, tools);
}

/** @param {Person} person */
function exportLink(person) {
  const link = create("a", {
    className: "button", href: `/records/people/${person.id}/export`, download: "",
    textContent: say("people.export"), ariaLabel: say("people.export_of", { name: person.name }),
  });
  let opened = !person.pin;
  link.addEventListener("click", (event) => {
    if (opened) return;
    event.preventDefault();
    pin.opened(person, () => {
      opened = true;
      link.click();
      opened = false;
    });
  });
  return link;
}

/** @param {Person} person */
function setPin(person) {
  pin.choose(person, () => {
    setText(byId("told"), say("pin.kept", { name: person.name }));
    attempt(refresh);
  });
}

/** @param {Person} person */
function removePin(person) {
  pin.opened(person, () => attempt(async () => {
    await ask("PUT", `/records/people/${person.id}/pin`, { pin: null });
    setText(byId("told"), say("pin.removed", { name: person.name }));
    await refresh();
  }));
}

/** @param {Person} person */
function driven({ drives, last }) {
  return last ? say("people.drives", { count: drives, when: sayTime(last, { dateStyle: "medium" }) }) : say("people.no_drives");
}

/** @param {`people.${"choose" | "rename" | "erase" | "pin_set" | "pin_remove"}`} word @param {Person | null} person @param {() => void} act @param {boolean} [pressed] */
function button(word, person, act, pressed) {
  const ariaLabel = say(`${word}_of`, { name: person?.name ?? say("settings.guest") });
  return createButton(say(pressed ? "people.chosen" : word), act, { ariaLabel, ...(pressed !== undefined && { ariaPressed: String(pressed) }) });
}

/** @param {Person} person */
function openRename(person) {
  about = person;
  newName.value = person.name;
  showProblem("", "rename-problem");
  renaming.showModal();
}

/** @param {Person} person */
function openErase(person) {
  attempt(async () => {
    const kept = await ask("GET", `/records/people/${person.id}`);
    about = person;
    setText(byId("erase-title"), say("people.erase_title", { name: person.name }));
    const lines = [
      say("people.erase_record"),
      kept.drives ? say("people.erase_drives", { count: kept.drives }) : "",
      kept.profiles ? say("people.erase_profiles", { count: kept.profiles }) : "",
      kept.episodes ? say("people.erase_episodes", { count: kept.episodes }) : "",
    ].filter(Boolean);
    byId("erase-list").replaceChildren(...lines.map((textContent) => create("li", { textContent })));
    showProblem("", "erase-problem");
    erasing.showModal();
  });
}

add.addEventListener("submit", (event) => {
  event.preventDefault();
  attempt(async () => {
    const person = await ask("POST", "/records/people", { name: nameField.value });
    nameField.value = "";
    choose(person);
  });
});
renaming.querySelector("form")?.addEventListener("submit", (event) => {
  event.preventDefault();
  attempt(async () => {
    if (!about) return;
    const person = await ask("PUT", `/records/people/${about.id}`, { name: newName.value });
    renaming.close();
    if (settings.person?.id === person.id) settings.rename(person.name);
    await refresh();
  }, "rename-problem");
});
erasing.querySelector("form")?.addEventListener("submit", (event) => {
  event.preventDefault();
  attempt(async () => {
    if (!about) return;
    await ask("DELETE", `/records/people/${about.id}`);
    erasing.close();
    settings.forget(about);
    setText(byId("told"), say("people.erased", { name: about.name }));
    await refresh();
  }, "erase-problem");
});
for (const close of document.querySelectorAll("[data-close]")) {
  close.addEventListener("click", () => close.closest("dialog")?.close());
}
byId("import").addEventListener("click", () => file.click());
file.addEventListener("change", () => {
  const [chosen] = file.files ?? [];
  file.value = "";
  if (chosen) attempt(async () => {
    const brought = await ask("POST", "/records/import", chosen);
    setText(byId("told"), say("people.imported", { name: brought.name, count: brought.drives }));
    await refresh();
  });
});
settings.addEventListener("person", () => attempt(refresh));
attempt(refresh);
