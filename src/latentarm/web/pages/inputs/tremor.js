/**
 * Steadies a trembling hand: the 1 € filter of Casiez, Roussel and Vogel (CHI 2012) on both axes.
 *
 * A first-order low-pass whose cut-off rises with the speed of the hand: slow pushes are steadied most, quick ones are
 * delayed least. Each value lies between the last one and the newest push, so it is causal and never overshoots. At rest
 * there is nothing to steady: letting go counts at once.
 */

/** Cut-off of a hand that is still, Hz, and by how much it rises with the hand's speed, Hz per 1/s. */
const STRENGTHS = {
  light: { stillHz: 2, perSpeed: 0.5 },
  medium: { stillHz: 1, perSpeed: 0.3 },
  strong: { stillHz: 0.5, perSpeed: 0.15 },
};
/** Cut-off for the hand's speed, Hz, as its authors have it. */
const SPEED_HZ = 1;
/** A longer gap between two pushes begins anew, s. */
const GAP_S = 0.2;
/** The page's usual time from one push to the next, and the longest that counts, s: late ones are steadied no less. */
const PERIOD_S = 0.02;

export class TremorFilter {
  constructor() {
    /** @type {[number, number]} */
    this._at = [0, 0];
    /** @type {[number, number]} */
    this._push = [0, 0];
    /** @type {[number, number]} */
    this._speed = [0, 0];
    this._atS = -Infinity;
  }

  /** Forget the hand: it has let go. */
  reset() {
    this._at = this._push = this._speed = [0, 0];
    this._atS = -Infinity;
  }

  /** The steadied push. @param {Values["tremor"]} strength @param {number} x right @param {number} y up @param {number} nowS @returns {[number, number]} */
  steady(strength, x, y, nowS) {
    if (strength === "off" || (x === 0 && y === 0)) {
      this.reset();
      return [x, y];
    }
    if (nowS === this._atS) return this._at;
    if (nowS - this._atS > GAP_S) this.reset();
    // A push that begins comes from rest, one usual period ago.
    const dtS = Math.min(nowS - this._atS, PERIOD_S);
    const { stillHz, perSpeed } = STRENGTHS[strength];
    const speed = /** @type {[number, number]} */ ([(x - this._push[0]) / dtS, (y - this._push[1]) / dtS]);
    this._speed = mixed(this._speed, speed, shareOf(SPEED_HZ, dtS));
    const cutOffHz = stillHz + perSpeed * Math.hypot(...this._speed);
    this._at = mixed(this._at, [x, y], shareOf(cutOffHz, dtS));
    this._push = [x, y];
    this._atS = nowS;
    return this._at;
  }
}

/** How much of the newest value a first-order low-pass takes. @param {number} hz @param {number} dtS */
function shareOf(hz, dtS) {
  return 1 / (1 + 1 / (2 * Math.PI * hz * dtS));
}

/** @param {[number, number]} before @param {[number, number]} now @param {number} share @returns {[number, number]} */
function mixed(before, now, share) {
  return [before[0] + share * (now[0] - before[0]), before[1] + share * (now[1] - before[1])];
}

/**
 * Steadies what is pushed by how far it is pushed; keys, buttons and switches are pressed or not.
 *
 * @param {Settings} settings @returns {(x: number, y: number, source: PersonInput["source"]) => [number, number]}
 */
export function attachTremor(settings) {
  const filter = new TremorFilter();
  return (x, y, source) => {
    const pushed = source === "pointer" || source === "gamepad";
    return filter.steady(pushed ? settings.values.tremor : "off", x, y, performance.now() / 1000);
  };
}
