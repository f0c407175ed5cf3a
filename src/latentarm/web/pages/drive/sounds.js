/** Short sounds at the end of a task, made by the browser: there is nothing to load. */

/** @import {Settings} from "../settings/settings.js" */

const LOUD = 0.18;
const FADE_S = 0.22;

/** Frequencies, Hz, one after the other. */
const TUNES = { success: [523, 659, 784], failure: [330, 247] };
const APART_S = 0.13;

/**
 * @param {Settings} settings
 * @param {new () => AudioContext} [Context]
 */
export function attachSounds(settings, Context = window.AudioContext) {
  /** @type {AudioContext | null} */
  let context = null;

  // Browsers are silent until somebody has pressed something.
  const wake = () => {
    if (!Context || !settings.values.sounds) return;
    context ??= new Context();
    if (context.state === "suspended") void context.resume();
  };
  for (const press of ["pointerdown", "keydown"]) window.addEventListener(press, wake, { capture: true, passive: true });

  return {
    /** @param {keyof typeof TUNES} tune */
    play(tune) {
      if (!settings.values.sounds || context === null) return;
      const { currentTime, destination } = context;
      for (const [number, hertz] of TUNES[tune].entries()) {
        const [tone, volume] = [context.createOscillator(), context.createGain()];
        const begins = currentTime + number * APART_S;
        tone.frequency.value = hertz;
        volume.gain.setValueAtTime(LOUD, begins);
        volume.gain.exponentialRampToValueAtTime(0.001, begins + FADE_S);
        tone.connect(volume).connect(destination);
        tone.start(begins);
        tone.stop(begins + FADE_S);
      }
    },
  };
}
