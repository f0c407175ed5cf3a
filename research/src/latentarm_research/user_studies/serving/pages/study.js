/** A participant's page: what is filled in goes to the server, which answers where to go on, or why not. */

const HOME = "/study";
/** Shown when the server does not answer. Read here, because the module that reads the words may not load either. */
const UNREACHABLE = JSON.parse(document.getElementById("words")?.textContent ?? "{}")["study.unreachable"];
/** The check of the device, which notes from now on what is used; null if it did not load. */
const device = import("./study_device.js").catch(() => null);
/** How often somebody who waits for an arm asks again, ms. */
const ASK_AGAIN_MS = 3000;
/** Time limit of a request, ms: a connection can go silent without an error. */
const ANSWER_MS = 60_000;

/** Shows how much of the check of the device is over. @param {number} part */
function checked(part) {
  const bar = /** @type {HTMLProgressElement | null} */ (document.getElementById("checking"));
  if (!bar) return;
  bar.parentElement?.toggleAttribute("hidden", false);
  bar.value = part;
}

/** The content of a form. @param {HTMLFormElement} form */
async function content(form) {
  const { to, digest, order } = form.dataset;
  if (to === "device") {
    const check = await device;
    // The page of the check has no answers that a reload would lose.
    if (!check) location.reload();
    return check?.checkDevice(checked);
  }
  if (to === "consent") return { digest };
  if (!["answers", "comprehension", "compare"].includes(to ?? "")) return {};
  const asText = new Set([...form.querySelectorAll("textarea, [data-options] input")].map((field) => field.getAttribute("name")));
  const data = new FormData(form);
  const given = [...new Set(data.keys())].map((name) => /** @type {const} */ ([name, data.getAll(name).join(";")]));
  const filled = given.filter(([, value]) => value.trim());
  const answers = Object.fromEntries(filled.map(([name, value]) => [name, asText.has(name) ? value : Number(value)]));
  return order === undefined ? { answers } : { order: Number(order), answers };
}

/** @param {HTMLFormElement} form @returns {Promise<{to?: string, problem?: string, waits_s?: number, lost?: boolean}>} */
async function send(form) {
  const headers = { "content-type": "application/json" };
  try {
    const body = JSON.stringify(await content(form));
    const signal = AbortSignal.timeout(ANSWER_MS);
    return await (await fetch(`${HOME}/${form.dataset.to}`, { method: "POST", headers, body, signal })).json();
  } catch {
    return { problem: UNREACHABLE, lost: true };
  }
}

/** Says how long it takes until an arm is free. @param {number} seconds */
async function waiting(seconds) {
  const words = await import(`${document.body.dataset.modules}/layout/words.js`).catch(() => null);
  // The page keeps waiting even if it cannot say for how long.
  if (!words || !busy) return;
  words.readWords();
  const text = words.say("study.waits", { count: Math.ceil(seconds / 60) });
  // A screen reader says what has changed.
  if (busy.textContent !== text) busy.textContent = text;
}

const problem = document.getElementById("problem");
const busy = document.getElementById("busy");
for (const form of document.querySelectorAll("form")) {
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const buttons = document.querySelectorAll("button");
    for (const button of buttons) button.disabled = true;
    problem?.parentElement?.toggleAttribute("hidden", true);
    busy?.toggleAttribute("hidden", form.dataset.to !== "begin");
    let answer = await send(form);
    // Who waits for an arm is told that it goes on by itself: a request that is lost on the way does not end that.
    for (let waits = false; answer.waits_s !== undefined || (waits && answer.lost); waits = true) {
      if (answer.waits_s !== undefined) await waiting(answer.waits_s);
      await new Promise((done) => setTimeout(done, ASK_AGAIN_MS));
      answer = await send(form);
    }
    if (answer.to) {
      location.assign(answer.to);
      return;
    }
    // Nothing is lost: the form stays as it is.
    if (problem) problem.textContent = answer.problem ?? "";
    problem?.parentElement?.toggleAttribute("hidden", false);
    busy?.toggleAttribute("hidden", true);
    for (const button of buttons) button.disabled = false;
  });
}

/** Count a slider as answered. @param {HTMLInputElement} slider */
function answered(slider) {
  slider.name = slider.dataset.name ?? "";
  slider.removeAttribute("aria-valuetext");
  const shown = slider.closest(".item")?.querySelector("output");
  if (shown) shown.textContent = slider.value;
}
for (const slider of /** @type {NodeListOf<HTMLInputElement>} */ (document.querySelectorAll("input[type=range]"))) {
  // A press on it or the space bar takes the place at which it stands; a click on its label, which is a click on it, does not.
  for (const kind of ["input", "pointerup"]) slider.addEventListener(kind, () => answered(slider));
  slider.addEventListener("keydown", ({ key }) => {
    if (key === " ") answered(slider);
  });
}

// A page from the history of the browser is an old one.
window.addEventListener("pageshow", (event) => {
  if (event.persisted) location.reload();
});
