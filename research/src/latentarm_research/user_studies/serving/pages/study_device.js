/** Checks a participant's browser, window, input devices and connection, over the socket that a drive uses. */

const CHECK_MS = 10_000;
/** How often a message goes to the server, ms. */
const EVERY_MS = 50;
/** How long the last answers may take, ms. */
const LATE_MS = 1000;

/** Kinds of input devices that were used on this page. @type {Set<string>} */
const used = new Set();
window.addEventListener("pointerdown", ({ pointerType }) => used.add(pointerType || "mouse"), true);
window.addEventListener("keydown", () => used.add("keyboard"), true);

/** The browser's name and version. */
function browser() {
  for (const name of ["Firefox", "Edg", "OPR", "Chrome", "Version"]) {
    const found = navigator.userAgent.match(new RegExp(`${name}/(\\d+)`));
    if (found) return `${{ Edg: "Edge", OPR: "Opera", Version: "Safari" }[name] ?? name} ${found[1]}`;
  }
  return "";
}

function webgl() {
  const gl = document.createElement("canvas").getContext("webgl2");
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return gl !== null;
}

/**
 * Times of messages to the server and back, ms; none where no socket opens.
 *
 * @param {(part: number) => void} shown Gets how much of the check is over, 0 to 1.
 * @returns {Promise<number[]>}
 */
function roundTrips(shown) {
  return new Promise((done) => {
    /** @type {number[]} */
    const sent = [];
    /** @type {number[]} */
    const took = [];
    const begun = performance.now();
    const socket = new WebSocket(`${location.origin.replace("http", "ws")}/drive`);
    const sending = setInterval(() => {
      const now = performance.now();
      shown(Math.min((now - begun) / CHECK_MS, 1));
      if (now - begun > CHECK_MS + LATE_MS) end();
      else if (now - begun < CHECK_MS && socket.readyState === WebSocket.OPEN) {
        socket.send(String(sent.length));
        sent.push(now);
      }
    }, EVERY_MS);
    socket.addEventListener("message", ({ data }) => {
      took[Number(data)] = performance.now() - sent[Number(data)];
    });
    socket.addEventListener("close", end);
    function end() {
      clearInterval(sending);
      socket.close();
      // A message that never came back counts as late.
      done(took.length ? sent.map((_, at) => took[at] ?? CHECK_MS) : []);
    }
  });
}

/** What the server judges. @param {(part: number) => void} shown See `roundTrips`. */
export async function checkDevice(shown) {
  const times = (await roundTrips(shown)).sort((one, other) => one - other);
  const at = (/** @type {number} */ share) => times[Math.floor(share * (times.length - 1))];
  if (navigator.getGamepads().some((pad) => pad !== null)) used.add("gamepad");
  return {
    browser: browser(),
    webgl: webgl(),
    width_px: window.innerWidth,
    height_px: window.innerHeight,
    inputs: [...used],
    round_trip_ms: times.length ? at(0.5) : null,
    jitter_ms: times.length ? at(0.95) - at(0.5) : null,
  };
}
