/**
 * One switch or two on the study's own pages, with the settings and the modules of the Drive page.
 *
 * Nobody can choose a switch by a switch. So its key does on the first page, where nothing has the focus; the Drive page
 * has the other settings.
 */

export {};

const load = (/** @type {string} */ path) => import(`${document.body.dataset.modules}/${path}.js`);
const [{ readWords }, { Settings }, { Deflection }, { pageControls, elementOf }, { attachScanning }] = await Promise.all(
  ["layout/words", "settings/settings", "inputs/deflection", "inputs/page_controls", "inputs/scanning"].map(load),
);

/** Questions without an answer; a slider has a name once it was set. */
const OPEN = "fieldset:not(:has(:checked)), fieldset:not(:has(:checked)) label, label:has(:required:not(:checked)), label:has([type=range]:not([name]))";

/** Everything that can be pressed. The light begins at what is to be done; the one answer to a question leads back there. @param {Group} group */
function choices(group) {
  /** @type {Group} */
  const question = (id, label, inner) => group(id, label, () => inner().map((answer) => (
    elementOf(answer)?.querySelector("[type=radio]") ? Object.assign(answer, { stays: false }) : answer
  )));
  const found = /** @type {Choice[]} */ (pageControls(document.getElementById("main"), question));
  const next = found.find((choice) => elementOf(choice)?.matches(OPEN));
  if (next) next.first = true;
  return found;
}

readWords();
const settings = new Settings();
const input = Object.assign(new Deflection(), { live: false, flowing: false, halt: () => {} });
const stopArm = () => fetch("/stop", { method: "POST", keepalive: true }).catch(() => {});
attachScanning(input, settings, stopArm, (/** @type {Choice} */ _, /** @type {Group} */ group) => choices(group));
if (document.body.dataset.part === "consent") window.addEventListener("keydown", ({ code }) => {
  const begins = code === settings.values.switchKey && document.activeElement === document.body;
  if (begins && settings.values.panel !== "switch") settings.change({ panel: "switch" });
});
