/**
 * One pointer that holds a control, from its press until it comes up.
 *
 * @param {HTMLElement} element
 * @param {{begins: (event: PointerEvent) => boolean, moves?: (event: PointerEvent) => void, ends: () => void, missed: () => void, lost: () => void}} does
 *   `begins` tells whether it is held from now on; it is `missed` where it came up some time ago, and `lost` where it was taken away
 * @returns {() => void} forgets the press
 */
export function attachHeldPointer(element, { begins, moves = () => {}, ends, missed, lost }) {
  /** @type {number | null} */
  let held = null;

  element.addEventListener("pointerdown", (event) => {
    if (held !== null || event.button !== 0 || !begins(event)) return;
    held = event.pointerId;
    element.setPointerCapture(held);
  });
  // On the window: a pointer that is no longer captured moves elsewhere.
  window.addEventListener("pointermove", (event) => {
    if (event.pointerId !== held) return;
    if (event.buttons !== 0) {
      moves(event);
      return;
    }
    // Some browsers lose the release, and then the pointer moves with no button down: it has let go.
    held = null;
    missed();
  }, { capture: true });
  for (const [type, does] of /** @type {const} */ ([["pointerup", ends], ["pointercancel", lost], ["lostpointercapture", lost]])) {
    element.addEventListener(type, (event) => {
      // After an ordinary release the capture is lost too, and nothing is held any more.
      if (event.pointerId !== held) return;
      held = null;
      does();
    });
  }
  element.addEventListener("contextmenu", (event) => event.preventDefault());
  return () => {
    held = null;
  };
}
