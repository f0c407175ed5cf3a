/** Where names stand: in rows along the edges of a view, each with a thin line to its point; nothing lies over what must be seen. */

/** @typedef {{left: number, top: number, right: number, bottom: number}} Box px from the left upper corner of the view */

/**
 * @typedef {object} Name
 * @property {number} x of its point, px
 * @property {number} y
 * @property {number} wide px
 * @property {number} narrow its width where only its mark is shown, px
 * @property {Place | null} [before] where it stood last, which it leaves only if it must
 */

/** @typedef {{left: number, top: number, cut: boolean, leader: {x: number, y: number} | null}} Place `leader`: where its line begins; null for none */

export const ROW_PX = 23;
const EDGE_PX = 4;
/** What is better not covered counts like so much of a longer line, px. */
const AVOIDED_PX = 90;
/** A name stays where it stood if another row is nearer by less, px. */
const STAYS_PX = 60;

/**
 * @param {Name[]} names the most important first
 * @param {Box[]} kept what must be seen
 * @param {Box[]} avoided what is better seen
 * @param {{width: number, height: number}} view px
 * @returns {(Place | null)[]} null where a name has no room
 */
export function layOutNames(names, kept, avoided, { width, height }) {
  const rows = Array.from({ length: Math.max(Math.floor((height - EDGE_PX) / ROW_PX), 0) }, (_, row) => EDGE_PX + row * ROW_PX);
  /** @type {Box[]} */
  const taken = [];
  return names.map(({ x, y, wide, narrow, before }) => {
    for (const cut of [false, true]) {
      const size = cut ? narrow : wide;
      if (size > width - 2 * EDGE_PX) continue;
      const places = rows.flatMap((top) => [EDGE_PX, width - size - EDGE_PX].map((left) => {
        const box = { left, top, right: left + size, bottom: top + ROW_PX - 2 };
        const stays = before && before.cut === cut && before.top === top && (before.left === EDGE_PX) === (left === EDGE_PX);
        const away = Math.hypot(top + ROW_PX / 2 - y, Math.max(left - x, x - left - size, 0));
        const over = avoided.filter((other) => overlap(box, other)).length;
        return { box, away: away + AVOIDED_PX * over - (stays ? STAYS_PX : 0) };
      })).filter(({ box }) => ![...kept, ...taken].some((other) => overlap(box, other)));
      if (!places.length) continue;
      const { box } = places.reduce((best, one) => (one.away < best.away ? one : best));
      taken.push(box);
      // From the nearest edge: at the side in the middle, above or below straight over the point.
      const fromX = Math.min(Math.max(x, box.left), box.right);
      const from = { x: fromX, y: fromX !== x ? box.top + (ROW_PX - 2) / 2 : y < box.top ? box.top : box.bottom };
      const inTheWay = [...kept.filter((other) => !holds(other, x, y)), ...taken.slice(0, -1)];
      const clear = !holds(box, x, y) && !inTheWay.some((other) => crosses(from, { x, y }, other));
      return { left: box.left, top: box.top, cut, leader: clear ? from : null };
    }
    return null;
  });
}

/** @param {Box} one @param {Box} other */
export function overlap(one, other) {
  return one.left < other.right && other.left < one.right && one.top < other.bottom && other.top < one.bottom;
}

/** @param {Box} box @param {number} x @param {number} y */
function holds({ left, top, right, bottom }, x, y) {
  return left <= x && x <= right && top <= y && y <= bottom;
}

/**
 * Whether a line goes through a box: the stretches inside its width and inside its height have a part in common.
 *
 * @param {{x: number, y: number}} from @param {{x: number, y: number}} to @param {Box} box
 */
export function crosses(from, to, { left, top, right, bottom }) {
  const within = (/** @type {number} */ start, /** @type {number} */ end, /** @type {number} */ low, /** @type {number} */ high) => {
    if (start === end) return low < start && start < high ? [0, 1] : [1, 0];
    const [one, other] = [(low - start) / (end - start), (high - start) / (end - start)];
    return [Math.min(one, other), Math.max(one, other)];
  };
  const [across, along] = [within(from.x, to.x, left, right), within(from.y, to.y, top, bottom)];
  return Math.max(across[0], along[0], 0) < Math.min(across[1], along[1], 1);
}
