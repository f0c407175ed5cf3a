/** Where another page drives, the stick and the buttons do nothing, and are shown so; a press of them says why. */

/** @param {HTMLElement[]} controls @param {Connection} connection @param {() => void} refused */
export function attachWatching(controls, connection, refused) {
  let watching = "false";
  connection.addEventListener("state", () => {
    watching = String(!connection.driving && connection.state?.driver !== null);
    for (const one of controls) if (one.getAttribute("aria-disabled") !== watching) one.setAttribute("aria-disabled", watching);
  });
  // Capture: before the control takes the press.
  for (const one of controls) one.addEventListener("pointerdown", (event) => {
    if (watching !== "true") return;
    event.stopPropagation();
    refused();
  }, { capture: true });
}
