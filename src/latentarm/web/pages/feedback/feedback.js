/** Sounds and vibrations when the arm is enabled or stops, or when a task ends, as far as the person wants them. */

import { whenever } from "../layout/dom.js";
import { play } from "./sounds.js";

/** @import {Occasion} from "./sounds.js" */

/** Lengths of what is felt and of the pauses between, ms. @type {Partial<Record<Occasion, number[]>>} */
const SHAKES = { stopped: [250], success: [90, 70, 90] };

/** @param {Connection} connection @param {Settings} settings @returns {{tell: (occasion: Occasion) => void}} */
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
  return { tell };
}
