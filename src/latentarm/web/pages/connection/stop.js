/**
 * Stop: on press, on Escape and on Space, from every page and every dialog. It needs no focus and no mouse.
 *
 * Where a person has made Space one of their switches, Space is that while they scan.
 */

/** @param {Connection} connection @param {() => void} [alsoHere] what this page lets go of @param {() => boolean} [spaceStops] whether Space is no switch */
export function attachStop(connection, alsoHere = () => {}, spaceStops = () => true) {
  const stop = () => {
    alsoHere();
    // Where the connection is doubtful, by another way as well; the arm also stops by itself when inputs cease.
    if (!connection.send({ type: "stop" }) || !connection.fresh) fetch("/stop", { method: "POST", keepalive: true }).catch(() => {});
  };
  // Capture, on the window: before anything else on the page can keep the press for itself.
  window.addEventListener("pointerdown", (event) => {
    if (isStop(event.target)) stop();
  }, { capture: true });
  window.addEventListener("click", (event) => {
    if (event.detail === 0 && isStop(event.target)) stop();
  }, { capture: true });
  window.addEventListener("keydown", (event) => {
    if (event.code !== "Space" && event.code !== "Escape") return;
    if (event.code === "Space") {
      const target = event.target instanceof Element ? event.target : null;
      // While the arm stands disengaged and nobody guides it, Space may press buttons and tick boxes as it always does.
      const still = !connection.engaged && connection.state?.guiding !== "on";
      const means = target?.matches("textarea, input[type=text]:not([readonly])") || (still && target?.closest("button, input, select, summary, a"));
      if (!spaceStops() || means) return;
      event.preventDefault();
    }
    stop();
  }, { capture: true });
  // A button that has the focus acts when Space comes up.
  window.addEventListener("keyup", (event) => {
    if (event.code === "Space" && connection.state?.phase === "stopping") event.preventDefault();
  }, { capture: true });
  return stop;
}

/** @param {EventTarget | null} target */
function isStop(target) {
  return target instanceof Element && target.closest("#stop, [data-stop]") !== null;
}
