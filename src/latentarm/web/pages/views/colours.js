/** The page's colours, as the style sheet has them now, for what is drawn by other means. */

/** @type {Direction[]} */
const ROUND = ["right", "up", "left", "down"];

/** A direction's colour, by hue between those of the nearest arrows. @param {number} turn counter-clockwise from the right, in [0, 1) of a whole turn */
export function directionColour(turn) {
  const quarter = Math.floor(4 * turn);
  const [from, to] = [ROUND[quarter], ROUND[(quarter + 1) % 4]];
  return `color-mix(in oklch, var(--ghost-${from}), var(--ghost-${to}) ${100 * (4 * turn - quarter)}%)`;
}

/** The same as `rgb()`, for the canvas. @param {number} turn */
export function directionPaint(turn) {
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(1, 1).getContext("2d"));
  context.fillStyle = resolved(directionColour(turn));
  context.fillRect(0, 0, 1, 1);
  return `rgb(${context.getImageData(0, 0, 1, 1).data.slice(0, 3).join()})`;
}

/** @param {string} name of a custom property, without its dashes */
export function colour(name) {
  return resolved(`var(--${name})`);
}

/** @param {string} value of a colour in the style sheet @returns {string} */
function resolved(value) {
  const probe = document.createElement("i");
  probe.style.color = value;
  // Where the system forces its colours on text, all of them would be the same.
  probe.style.setProperty("forced-color-adjust", "none");
  document.body.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}
