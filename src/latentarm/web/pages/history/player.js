/** Shows a drive again: play, pause, and any moment of it. */

import { between } from "../personalise/replay.js";

/** @import {Trace} from "../connection/messages.js" */
/** @typedef {ReturnType<typeof momentAt>} Moment */

const FRAME_MS = 33;

/** Every state of the things with all of the grains, which the trace leaves out where they are as before. @param {Trace} trace */
export function standing(trace) {
  /** @type {number[][]} */
  let grains = [];
  return trace.things.map((one) => {
    grains = one.grains ?? grains;
    return { t: one.t, state: { poses: one.poses, grains } };
  });
}

/** The drive at a time, s: between two moments, or unchanged for a while. @param {Trace} trace @param {ReturnType<typeof standing>} things @param {number} t */
export function momentAt(trace, things, t) {
  const index = Math.max(trace.t.findLastIndex((time) => time <= t), 0);
  const next = Math.min(index + 1, trace.t.length - 1);
  const begins = Math.max(trace.t[index], trace.t[next] - 1.5 * trace.period_s);
  const share = next > index ? Math.min(Math.max((t - begins) / (trace.t[next] - begins), 0), 1) : 0;
  const mark = trace.marks.findLast((one) => one.t <= t);
  return {
    t,
    bodies: between([trace.bodies[index], trace.bodies[next]], share),
    tool: trace.tool[index].map((from, axis) => from + share * (trace.tool[next][axis] - from)),
    width_m: trace.width_m[index],
    things: things.findLast((one) => one.t <= t)?.state ?? null,
    enabled: mark?.code === "enabled",
    stopped: mark !== undefined && mark.code !== "enabled",
  };
}

/** Event "moment" with each moment that is to be shown, in `detail`; "playing" when it begins or ends. */
export class Player extends EventTarget {
  /** @param {Trace} trace */
  constructor(trace) {
    super();
    this._trace = trace;
    this._things = standing(trace);
    this.t = 0;
    this.length = trace.t[trace.t.length - 1] ?? 0;
    this._before = 0;
    this._timer = 0;
  }

  get playing() {
    return this._timer !== 0;
  }

  play() {
    if (this.playing) return;
    if (this.t >= this.length) this.seek(0);
    this._before = performance.now();
    this._timer = setInterval(() => this._tick(), FRAME_MS);
    this.dispatchEvent(new Event("playing"));
  }

  pause() {
    if (!this.playing) return;
    clearInterval(this._timer);
    this._timer = 0;
    this.dispatchEvent(new Event("playing"));
  }

  /** @param {number} t s */
  seek(t) {
    this.t = Math.min(Math.max(t, 0), this.length);
    this._show();
  }

  _tick() {
    const now = performance.now();
    this.t = Math.min(this.t + (now - this._before) / 1000, this.length);
    this._before = now;
    this._show();
    if (this.t >= this.length) this.pause();
  }

  _show() {
    if (!this._trace.t.length) return;
    this.dispatchEvent(new CustomEvent("moment", { detail: momentAt(this._trace, this._things, this.t) }));
  }
}
