/** A motion by a switch that goes on by itself ends where its way ends: nobody presses a switch to the centimetre. */

/** So long passes from what is known of the arm until it stands still, ms. */
const AHEAD_MS = 80;
/** The speed is taken over this long, ms. */
const SPAN_MS = 150;

/** @param {DriveInput} input @param {Connection} connection @param {ReturnType<typeof import("./to_go.js").attachToGo>["left"]} left @param {() => boolean} on */
export function attachWayEnd(input, connection, left, on) {
  let driven = /** @type {Direction | undefined} */ (undefined);
  /** @type {{at: number, far: number}[]} */
  let seen = [];
  connection.addEventListener("state", () => {
    const direction = input.source === "switch" && input.latched && on() ? input.pressed[0] : undefined;
    if (driven !== direction) [driven, seen] = [direction, []];
    const far = direction ? left(direction) : null;
    // A motion that begins at the end, or leads away from it, is the person's own.
    if (far === null || (far <= 0 && !seen.length)) return;
    const at = performance.now();
    seen = [...seen.filter((one) => at - one.at < SPAN_MS), { at, far }];
    if (far * (at - seen[0].at) < (seen[0].far - far) * AHEAD_MS) input.neutral();
  });
}
