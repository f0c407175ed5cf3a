/**
 * Steadies a trembling hand: the 1 € filter of Casiez, Roussel and Vogel (CHI 2012) on both axes.
 *
 * A first-order low-pass whose cut-off rises with the speed of the hand: slow pushes are steadied most, quick ones are
 * delayed least. Each value lies between the last one and the newest push, so it is causal and never overshoots. At rest
 * there is nothing to steady: letting go counts at once.
 */

/** @typedef {[number, number]} Pair right and up */

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

/** A hand that has let go. @type {{at: Pair, push: Pair, speed: Pair, atS: number}} */
const AT_REST = { at: [0, 0], push: [0, 0], speed: [0, 0], atS: -Infinity };

export class TremorFilter {
  _hand = AT_REST;

  /** The steadied push. @param {Values["tremor"]} strength @param {number} x right @param {number} y up @param {number} nowS @returns {Pair} */
  steady(strength, x, y, nowS) {
    if (strength === "off" || (x === 0 && y === 0)) {
      this._hand = AT_REST;
      return [x, y];
    }
    if (nowS === this._hand.atS) return this._hand.at;
    const { at, push, speed, atS } = nowS - this._hand.atS > GAP_S ? AT_REST : this._hand;
    // A push that begins comes from rest, one usual period ago.
    const dtS = Math.min(nowS - atS, PERIOD_S);
    const { stillHz, perSpeed } = STRENGTHS[strength];
    const faster = mixed(speed, [(x - push[0]) / dtS, (y - push[1]) / dtS], shareOf(SPEED_HZ, dtS));
    const cutOffHz = stillHz + perSpeed * Math.hypot(...faster);
    this._hand = { at: mixed(at, [x, y], shareOf(cutOffHz, dtS)), push: [x, y], speed: faster, atS: nowS };
    return this._hand.at;
  }
}

/** How much of the newest value a first-order low-pass takes. @param {number} hz @param {number} dtS */
function shareOf(hz, dtS) {
  return 1 / (1 + 1 / (2 * Math.PI * hz * dtS));
}

/** @param {Pair} before @param {Pair} now @param {number} share @returns {Pair} */
function mixed(before, now, share) {
  return [before[0] + share * (now[0] - before[0]), before[1] + share * (now[1] - before[1])];
}

/**
 * Steadies what is pushed by how far it is pushed; keys, buttons and switches are pressed or not.
 *
 * @param {Settings} settings @returns {(x: number, y: number, source: PersonInput["source"]) => Pair}
 */
export function attachTremor(settings) {
  const filter = new TremorFilter();
  return (x, y, source) => {
    const pushed = source === "pointer" || source === "gamepad";
    return filter.steady(pushed ? settings.values.tremor : "off", x, y, performance.now() / 1000);
  };
}
