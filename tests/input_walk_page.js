/** What a walk needs in the page: gamepads that it can move, presses in time, and the page's own sockets. */
localStorage["latentarm.settings."] ??= JSON.stringify({ practised: true });
window.pads = [null, null, null];
window.alive = new Set();
navigator.getGamepads = () => window.pads;
const all = [];
window.sockets = all;
window.WebSocket = class extends WebSocket { constructor(...given) { super(...given); all.push(this); } };
window.plug = (index, axes) => {
  window.pads[index] = { index, id: `pad ${index}`, mapping: "standard", connected: true, axes, buttons: Array.from({ length: 6 }, () => ({ pressed: false })) };
};
// A hand on a stick is never quite still.
setInterval(() => {
  for (const index of window.alive) {
    const pad = window.pads[index];
    if (pad) pad.axes = pad.axes.map((axis) => axis + (Math.random() - 0.5) * 1e-3);
  }
}, 50);
const key = (type, code) => document.body.dispatchEvent(new KeyboardEvent(type, { code, bubbles: true, cancelable: true }));
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
window.presses = async (by, downMs, upMs, times) => {
  const press = by === "key" ? (is) => key(is ? "keydown" : "keyup", "Enter") : (is) => { if (pads[by]) pads[by].buttons[0].pressed = is; };
  for (let time = 0; time < times; time += 1) {
    press(true);
    await wait(downMs);
    press(false);
    await wait(upMs);
  }
};
