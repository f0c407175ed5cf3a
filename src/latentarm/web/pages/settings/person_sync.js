/** Keeps a person's settings on the server, so that they find them on every computer. */

import { UNSENT_KEY } from "./settings.js";
import * as storage from "./storage.js";

/** Changes in quick succession are sent once, ms. */
const WAIT_MS = 300;

/** @param {Settings} settings */
export function attachPersonSync(settings) {
  /** @type {{id: string, values: string} | null} */
  let waiting = null;
  let timer = 0;

  const send = () => {
    clearTimeout(timer);
    if (!waiting) return;
    const { id, values } = waiting;
    waiting = null;
    // A change without an answer counts here, and is sent again when the next page opens.
    fetch(`/records/people/${id}/settings`, { method: "PUT", body: values, keepalive: true })
      .then(() => storage.read(UNSENT_KEY + id) === values && storage.remove(UNSENT_KEY + id), () => {});
  };
  const edited = () => {
    if (!settings.person) return;
    if (waiting && waiting.id !== settings.person.id) send();
    waiting = { id: settings.person.id, values: JSON.stringify(settings.own) };
    storage.write(UNSENT_KEY + waiting.id, waiting.values);
    clearTimeout(timer);
    timer = setTimeout(send, WAIT_MS);
  };
  /** Whose record this browser may have opened by a PIN. */
  let before = settings.person?.id;
  const lock = () => {
    if (before && before !== settings.person?.id) fetch(`/records/people/${before}/lock`, { method: "POST", keepalive: true }).catch(() => {});
    before = settings.person?.id;
  };
  const look = async () => {
    const { person, values } = settings;
    if (!person) return;
    const answer = await fetch(`/records/people/${person.id}`, { cache: "no-store" }).catch(() => null);
    if (settings.person?.id !== person.id || settings.values !== values) return;
    if (answer?.status === 404) settings.forget(person);
    // Their PIN must be given first, on the People page.
    if (answer?.status === 403) settings.become(null);
    if (!answer?.ok) return;
    const known = await answer.json();
    settings.rename(known.name);
    const unsent = storage.read(UNSENT_KEY + person.id) !== null;
    if (unsent || !Object.keys(known.settings).length) edited();
    else settings.take(known.settings);
  };

  settings.addEventListener("edited", edited);
  settings.addEventListener("person", () => {
    send();
    lock();
    look();
  });
  window.addEventListener("pagehide", send);
  look();
}
