/** From the stick to what is sent: the person's own dead zone, reach, sensitivity and axes, and what the mode expects. */

/** From the edge of the dead zone to a full push it is at least so far: a smaller way would be a switch. */
const LEAST_WAY = 0.1;

/** The person's own push, right and up. @param {Values} settings @param {number} x right @param {number} y up @returns {[number, number]} */
export function shape({ deadZone, reach, sensitivity, swapAxes, invertX, invertY }, x, y) {
  const size = Math.hypot(x, y);
  if (size <= deadZone) return [0, 0];
  const larger = Math.max(Math.abs(x), Math.abs(y));
  // Grows from zero at the edge of the dead zone to full at the person's reach, a share of the way to the edge of the pad.
  const full = Math.max((reach * size) / larger, deadZone + LEAST_WAY);
  const scale = (sensitivity * Math.min(1, (size - deadZone) / (full - deadZone))) / larger;
  const right = (invertX ? -x : x) * scale;
  const up = (invertY ? -y : y) * scale;
  return swapAxes ? [up, right] : [right, up];
}

/** The input for learned motions: one axis or two. @param {Values} settings @param {Welcome | null} welcome @param {number} x @param {number} y */
export function latentInput(settings, welcome, x, y) {
  const [right, up] = shape(settings, x, y);
  return welcome?.latent_dim === 1 ? [right] : [right, up];
}

/** The input for the mode. @param {Values} settings @param {State | null} state @param {Welcome | null} welcome @param {number} x @param {number} y */
export function modeInput(settings, state, welcome, x, y) {
  if (state?.mode !== "end_effector") return latentInput(settings, welcome, x, y);
  const [right, up] = shape(settings, x, y);
  // The server's axes are the base frame's: forward and left, up and turn, roll and pitch.
  const facing = settings.seat === "facing" && state.axes === 0;
  return (facing ? [-up, right] : [up, -right]).map((value) => value + 0);
}
