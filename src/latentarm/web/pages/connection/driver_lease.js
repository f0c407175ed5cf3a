/** Who drives, who watches, and how the one becomes the other. */

/** How long the server may take to give a free seat, ms. */
const SEAT_MS = 1000;

/**
 * What is to be done once this page drives: at once, or soon where nobody drives; not where somebody else does.
 *
 * @param {import("./connection.js").Connection} connection
 */
export function seatFirst(connection) {
  let until = -Infinity;
  /** @type {() => void} */
  let then = () => {};
  connection.addEventListener("state", () => {
    if (performance.now() > until || !connection.driving) return;
    until = -Infinity;
    then();
  });
  return {
    /** @param {() => void} act */
    ask(act) {
      if (connection.driving) {
        act();
        return;
      }
      if (connection.state?.driver === null) {
        then = act;
        until = performance.now() + SEAT_MS;
      }
      connection.send("ask_to_drive");
    },
    forget() {
      until = -Infinity;
    },
  };
}

/**
 * @param {{text: HTMLElement, ask: HTMLButtonElement, handOver: HTMLButtonElement, release: HTMLButtonElement}} parts
 * @param {import("./connection.js").Connection} connection
 */
export function attachSeat(parts, connection) {
  parts.ask.addEventListener("click", () => connection.send("ask_to_drive"));
  parts.release.addEventListener("click", () => connection.send("release"));
  parts.handOver.addEventListener("click", () => {
    const asking = connection.state?.asking;
    if (asking) connection.send("hand_over", { to: asking });
  });

  connection.addEventListener("state", () => {
    const { you, driver, driver_name, asking, asking_name, watchers } = connection.state;
    const askedHere = asking !== null && asking === connection.welcome?.id;
    parts.ask.hidden = you;
    parts.ask.disabled = askedHere;
    parts.release.hidden = !you;
    parts.handOver.hidden = !you || asking === null;
    parts.handOver.textContent = `Hand over to ${asking_name || "the person who asks"}`;
    const others = ["", "; one other page watches"][watchers] ?? `; ${watchers} other pages watch`;
    let text = "Nobody is driving.";
    if (you) text = asking ? `You are driving. ${asking_name || "Somebody"} asks to drive.` : `You are driving${others}.`;
    else if (driver !== null) {
      text = `${driver_name || "Somebody else"} is driving; you are watching, and may stop the arm.`;
      if (askedHere) text += " You have asked to drive.";
    }
    if (parts.text.textContent !== text) parts.text.textContent = text;
  });
}
