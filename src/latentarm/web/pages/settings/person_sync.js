/** Keeps a person's settings on the server, so that they find them on every computer. */

/** @import {Settings} from "./settings.js" */

/** Changes in quick succession are sent once, ms. */
const WAIT_MS = 300;

/** @param {Settings} settings */
export function attachPersonSync(settings) {
  /** @type {{id: string, values: string} | null} */
  let waiting = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  const send = () => {
    clearTimeout(timer);
    if (!waiting) return;
    const { id, values } = waiting;
    waiting = null;
    // A lost change goes with the next one; until then this browser has it.
    fetch(`/records/people/${id}/settings`, { method: "PUT", body: values, keepalive: true }).catch(() => {});
  };
  const edited = () => {
    if (!settings.person) return;
    if (waiting && waiting.id !== settings.person.id) send();
    waiting = { id: settings.person.id, values: JSON.stringify(settings.values) };
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
    const { person } = settings;
    if (!person) return;
    const answer = await fetch(`/records/people/${person.id}`, { cache: "no-store" }).catch(() => null);
    if (settings.person?.id !== person.id || waiting) return;
    if (answer?.status === 404) settings.forget(person);
    // Their PIN must be given first, on the People page.
    if (answer?.status === 403) settings.become(null);
    if (!answer?.ok) return;
    const known = await answer.json();
    settings.rename(known.name);
    if (Object.keys(known.settings).length) settings.take(known.settings);
    else edited();
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
