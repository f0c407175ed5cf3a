/** Sounds and vibrations when the arm is enabled or stops, or when a task ends, as far as the person wants them: short, quiet tones, made by the browser. */

import { whenever } from "../layout/dom.js";

/** @typedef {"enabled" | "stopped" | "success" | "failure"} Occasion */

/** Of full loudness. */
const LOUDNESS = 0.06;
const TONE_S = 0.12;
/** A tone swells and fades within this, s: it would click otherwise. */
const SWELL_S = 0.02;

/** Frequencies of the tones, one after the other, Hz. @type {Record<Occasion, number[]>} */
const TONES = { enabled: [523], stopped: [392, 262], success: [523, 659, 784], failure: [330, 247] };
/** Lengths of what is felt and of the pauses between, ms. @type {Partial<Record<Occasion, number[]>>} */
const SHAKES = { stopped: [250], success: [90, 70, 90] };

/** @param {Connection} connection @param {Settings} settings @returns {(occasion: Occasion) => void} */
export function attachFeedback(connection, settings) {
  const tell = (/** @type {Occasion} */ occasion) => {
    const { sounds, vibration } = settings.values;
    const ends = occasion === "success" || occasion === "failure";
    if (sounds === "all" || (sounds === "success" && ends)) play(occasion);
    const shake = SHAKES[occasion];
    if (vibration && shake) navigator.vibrate?.(shake);
  };
  let engaged = false;
  const look = () => {
    if (connection.engaged === engaged) return;
    engaged = connection.engaged;
    tell(engaged ? "enabled" : "stopped");
  };
  whenever(connection, ["state", "open"], look);
  return tell;
}

/** @type {AudioContext | null} */
let context = null;

/** @param {Occasion} occasion */
function play(occasion) {
  const audio = (context ??= new AudioContext());
  // A page that nobody has touched yet may not sound.
  if (audio.state === "suspended") audio.resume();
  const now = audio.currentTime;
  TONES[occasion].forEach((frequency, index) => {
    const [begin, end] = [now + index * TONE_S, now + (index + 1) * TONE_S];
    const source = new OscillatorNode(audio, { frequency });
    const loudness = new GainNode(audio, { gain: 0 });
    loudness.gain.setValueAtTime(0, begin);
    loudness.gain.linearRampToValueAtTime(LOUDNESS, begin + SWELL_S);
    loudness.gain.setValueAtTime(LOUDNESS, end - SWELL_S);
    loudness.gain.linearRampToValueAtTime(0, end);
    source.connect(loudness).connect(audio.destination);
    source.start(begin);
    source.stop(end);
  });
}
