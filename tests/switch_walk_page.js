/** Notes in the page of a walk: what was lit at each press of a switch, and what the press led to. */
const isSwitch = (code) => (sessionStorage.keys ?? "").split(" ").includes(code);
const told = (what) => {
  const all = JSON.parse(sessionStorage.told ?? "[]");
  sessionStorage.told = JSON.stringify([...all, what]);
};
window.print = () => {};
let pressing = false;
/** @type {Element | null} */
let wasLit = null;
/** @type {Map<HTMLDetailsElement, boolean>} Whether each was open before the press. */
let wereOpen = new Map();
const switched = () => !document.getElementById("panel-switch").hidden;
const textOf = (one) => one instanceof HTMLInputElement && !one.readOnly && one.selectionStart !== null;
addEventListener("keydown", (event) => {
  // Somebody with other settings may have been chosen.
  if (!isSwitch(event.code) || event.repeat || !switched()) return;
  pressing = true;
  wereOpen = new Map([...document.querySelectorAll("details")].map((one) => [one, one.open]));
  const choice = document.querySelector("#scan [aria-current=true]");
  const lit = wasLit = document.querySelector(".lit");
  const kept = textOf(event.target) || "asking" in event.target.dataset;
  told({ pressed: choice?.dataset.choice ?? null, label: choice?.textContent, lit: lit?.outerHTML.slice(0, 160) ?? null, tag: lit?.localName ?? null, kept });
}, { capture: true });
addEventListener("keyup", () => setTimeout(() => { pressing = false; }), { capture: true });
for (const type of ["click", "input", "change", "submit"]) {
  addEventListener(type, (event) => {
    if (!pressing) return;
    const { target, isTrusted } = event;
    // A form is sent by the click before it.
    const byBrowser = isTrusted && type !== "submit";
    const elsewhere = type === "click" && wasLit !== null && !wasLit.contains(target);
    if (byBrowser || elsewhere) told({ event: type, byBrowser, elsewhere, target: target.outerHTML?.slice(0, 160) });
  }, { capture: true });
}
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (text) {
  if (String(text).includes('"type":"enable"')) told({ enable: true });
  return send.call(this, text);
};
window.snap = () => {
  const on = switched();
  const lit = [...document.querySelectorAll("#scan [aria-current=true]")].filter((one) => one.checkVisibility());
  const seen = lit.filter((one) => {
    const { left, top, width, height } = one.getBoundingClientRect();
    return one.contains(document.elementFromPoint(left + width / 2, top + height / 2));
  });
  const open = [...document.querySelectorAll("details[open], dialog[open], :popover-open")];
  const told = JSON.parse(sessionStorage.told ?? "[]");
  sessionStorage.told = "[]";
  const focus = document.activeElement;
  // One that has come or gone with its part of the page was not toggled.
  const toggled = [...wereOpen].filter(([one, open]) => one.isConnected && one.open !== open);
  return {
    on, lit: lit.length, seen: seen.map((one) => one.textContent), lights: document.getElementsByClassName("lit").length, told,
    row: lit.some((one) => one.dataset.choice?.startsWith("row-")),
    path: location.pathname, open: open.map((one) => `${one.localName} ${one.id || one.textContent.trim().slice(0, 30)}`),
    focus: focus?.outerHTML.slice(0, 120) ?? "", stop: document.querySelectorAll("#scan [data-choice=stop]").length,
    toggled: toggled.map(([one]) => one.textContent.trim().slice(0, 30)), asking: "asking" in (focus?.dataset ?? {}),
    switches: JSON.parse(localStorage["latentarm.settings."] ?? "{}").switches,
    choices: [...document.querySelectorAll("#scan li")].map((one) => one.dataset.choice).join(" "),
  };
};
window.targets = () => [...document.querySelectorAll("a[href], button, summary, select, label, input")].flatMap((one) => {
  if (one.matches("#import, #card-print, #print, [download], [name=panel]") || one.querySelector("[name=panel]")) return [];
  const { left, top, width, height } = one.getBoundingClientRect();
  const [x, y] = [left + width / 2, top + height / 2];
  const hit = width > 0 && document.elementFromPoint(x, y);
  return hit && one.contains(hit) ? [{ x, y, html: one.outerHTML.slice(0, 120), select: one.localName === "select" }] : [];
});
