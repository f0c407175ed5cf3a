/**
 * Whether a keyboard is at hand. No browser says so: where something points finely and hovers, as a mouse does, a keyboard is
 * likely; everywhere else nothing is said of keys before one has been pressed. A touch screen's own keyboard sends no codes.
 */

/** Marks the page: what carries `about-keys` is shown only where keys are at hand. */
export function attachKeysAtHand() {
  const desk = matchMedia("(any-pointer: fine) and (any-hover: hover)");
  const mark = () => document.documentElement.setAttribute("data-keys", "");
  if (desk.matches) mark();
  desk.addEventListener("change", mark);
  window.addEventListener("keydown", ({ code }) => code && mark(), { capture: true });
}
