/** The screen stays on while this page drives an enabled arm, or guides one: a screen that goes dark takes Stop with it. */

/** A lock that was refused or taken back is asked for so much later, ms. */
const AGAIN_MS = 1000;

/** Browsers offer it to secure pages alone; elsewhere the system's own setting counts. @param {Connection} connection */
export function attachWakeLock(connection) {
  const screens = navigator.wakeLock;
  if (!screens) return;
  /** @type {WakeLockSentinel | null} */
  let lock = null;
  let [asks, askedAt] = [false, -Infinity];

  const look = async () => {
    if (asks) return;
    if (!connection.driving || !(connection.engaged || connection.state?.guiding === "on")) {
      lock?.release();
      [lock, askedAt] = [null, -Infinity];
      return;
    }
    // The system takes it back from a page that is hidden, or when the battery is nearly empty: the arm can be driven all the same.
    if ((lock && !lock.released) || document.hidden || performance.now() - askedAt < AGAIN_MS) return;
    [asks, askedAt] = [true, performance.now()];
    lock = await screens.request("screen").catch(() => null);
    asks = false;
    // The arm may have stopped meanwhile.
    look();
  };
  for (const news of ["state", "open"]) connection.addEventListener(news, look);
  document.addEventListener("visibilitychange", look);
}
