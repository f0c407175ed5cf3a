/** What the stick moves: latent actions, with help or without, or the tool along two axes at a time. */

/** @type {Record<string, string>} */
const MODE_LABELS = { latent: "Learned motions", assisted: "Learned, with help", end_effector: "Tool directions" };
/** @type {Record<string, string>} */
const AXES_LABELS = { "x-y": "Across", "z-yaw": "Height, turn", "roll-pitch": "Tilt" };

/** How long the server may take to change the mode, ms. */
const ANSWER_MS = 300;

/**
 * @param {{mode: HTMLElement, axes: HTMLElement}} parts the two fieldsets
 * @param {import("../connection/connection.js").Connection} connection
 */
export function attachModes(parts, connection) {
  let modes = /** @type {string[]} */ ([]);
  let axes = /** @type {string[]} */ ([]);

  let askedAt = -Infinity;

  const ask = (/** @type {string} */ mode, /** @type {number} */ pair) => {
    askedAt = performance.now();
    connection.send("mode", mode === "end_effector" ? { mode, axes: pair } : { mode });
  };
  connection.addEventListener("welcome", () => {
    modes = connection.welcome.modes;
    axes = connection.welcome.end_effector_modes;
    fill(parts.mode, "mode", modes.map((mode) => MODE_LABELS[mode] ?? mode), (index) => ask(modes[index], 0));
    fill(parts.axes, "axes", axes.map((label) => AXES_LABELS[label] ?? label), (index) => ask("end_effector", index));
  });
  connection.addEventListener("state", () => {
    // What was just chosen stays chosen until the server has had time to say otherwise.
    if (performance.now() - askedAt < ANSWER_MS) return;
    const { mode, axes: pair, you } = connection.state;
    check(parts.mode, modes.indexOf(mode), you);
    check(parts.axes, pair, you);
    parts.axes.hidden = mode !== "end_effector";
  });

  return {
    next() {
      if (!connection.state || modes.length === 0) return;
      const { mode, axes: pair } = connection.state;
      // Through the pairs of axes first: that is how a switch reaches all of them.
      if (mode === "end_effector" && pair + 1 < axes.length) ask(mode, pair + 1);
      else ask(modes[(modes.indexOf(mode) + 1) % modes.length], 0);
    },
    /** @param {number} index */
    axes(index) {
      if (index < axes.length) ask("end_effector", index);
    },
  };
}

/** @param {HTMLElement} fieldset @param {string} name @param {string[]} labels @param {(index: number) => void} chosen */
function fill(fieldset, name, labels, chosen) {
  const options = labels.map((text, index) => {
    const label = document.createElement("label");
    const input = Object.assign(document.createElement("input"), { type: "radio", name, value: String(index) });
    input.addEventListener("change", () => chosen(index));
    label.append(input, Object.assign(document.createElement("span"), { textContent: text }));
    return label;
  });
  /** @type {HTMLElement} */ (fieldset.querySelector(".options")).replaceChildren(...options);
}

/** Show what the server says, not what was clicked. @param {HTMLElement} fieldset @param {number} index @param {boolean} free */
function check(fieldset, index, free) {
  fieldset.querySelectorAll("input").forEach((input, number) => {
    if (input.checked !== (number === index)) input.checked = number === index;
    if (input.disabled === free) input.disabled = !free;
  });
}
