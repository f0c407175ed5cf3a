/** Auditory scanning: what is lit is spoken, in the language of the page. */

/** @import {Settings} from "../settings/settings.js" */

/**
 * @param {Settings} settings
 * @returns {(text: string) => void} speaks a text in place of what is being spoken, where the person wants that
 */
export function attachSpeech(settings) {
  let said = "";
  return (text) => {
    const { speak, speakVolume } = settings.values;
    if (!speak || text === said || !("speechSynthesis" in window)) {
      if (!speak) said = "";
      return;
    }
    said = text;
    speechSynthesis.cancel();
    if (text === "") return;
    const utterance = new SpeechSynthesisUtterance(text);
    utterance.lang = document.documentElement.lang;
    utterance.volume = speakVolume;
    speechSynthesis.speak(utterance);
  };
}
