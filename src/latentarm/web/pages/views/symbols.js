/** A shape and a colour for each goal, the same in views, labels and lists: nobody must tell colours apart. */

const SHAPES = [
  { symbol: "●", corners: 32, turn: 0 },
  { symbol: "▲", corners: 3, turn: Math.PI / 2 },
  { symbol: "■", corners: 4, turn: Math.PI / 4 },
  { symbol: "◆", corners: 4, turn: 0 },
  { symbol: "⬟", corners: 5, turn: Math.PI / 2 },
];

/** The sign in texts; the ring in views: how many corners, and how far it is turned, rad. @param {number} index of the goal */
export function shapeOf(index) {
  return SHAPES[index % SHAPES.length];
}

/** The number of its colour in the style sheet, from 1 on. @param {number} index of the goal */
export function colourOf(index) {
  return 1 + (index % SHAPES.length);
}
