/** A motion shown again and again: the start, the motion as fast as the person drives, a short hold. */

const REST_MS = 700;
const HOLD_MS = 900;
const FRAME_MS = 33;

/** @typedef {import("../connection/messages.js").ShownMotion} Motion */

export class Replay {
  /** @param {(bodies: number[][]) => void} show @param {(bodies: number[][] | null) => void} shadow a second arm @param {() => number} speed of full speed */
  constructor(show, shadow, speed) {
    this._show = show;
    this._shadow = shadow;
    this._speed = speed;
    this._still = matchMedia("(prefers-reduced-motion: reduce)");
    /** @type {Motion | null} */
    this._motion = null;
    this._began = 0;
    this._timer = 0;
    this._still.addEventListener("change", () => this.again());
  }

  /** @param {Motion | null} motion */
  play(motion) {
    this._motion = motion;
    this.again();
  }

  /** From the start; without motion where people want none: the arm at the start, and as a shadow at the end. */
  again() {
    clearInterval(this._timer);
    const motion = this._motion;
    this._shadow(motion && this._still.matches ? motion.frames[motion.frames.length - 1] : null);
    if (!motion) return;
    this._show(motion.frames[0]);
    if (this._still.matches) return;
    this._began = performance.now();
    this._timer = setInterval(() => this._tick(motion), FRAME_MS);
  }

  /** @param {Motion} motion */
  _tick(motion) {
    const moving = (1000 * motion.duration_s) / this._speed();
    const passed = (performance.now() - this._began) % (REST_MS + moving + HOLD_MS);
    const share = Math.min(Math.max((passed - REST_MS) / moving, 0), 1);
    this._show(between(motion.frames, share));
  }
}

/** The poses at a share of a motion, between its frames. @param {number[][][]} frames @param {number} share */
export function between(frames, share) {
  const at = share * (frames.length - 1);
  const whole = Math.min(Math.floor(at), frames.length - 2);
  return frames[whole].map((from, body) => mixed(from, frames[whole + 1][body], at - whole));
}

/** @param {number[]} from x, y, z and a quaternion @param {number[]} to @param {number} share */
function mixed(from, to, share) {
  const alike = from.slice(3).reduce((sum, value, axis) => sum + value * to[3 + axis], 0) < 0 ? -1 : 1;
  const pose = from.map((value, axis) => value + share * ((axis < 3 ? 1 : alike) * to[axis] - value));
  const length = Math.hypot(...pose.slice(3));
  return pose.map((value, axis) => (axis < 3 ? value : value / length));
}
