/** What is lit, and what is to be done now, out loud in the language of the page. */

/**
 * @param {Pick<Settings, "values">} settings
 * @param {"speak" | "speakNext"} option which setting asks for it
 * @param {number} [settleMs] how long a text must stay to be spoken, ms; such a text interrupts nothing
 * @returns {(text: string) => void} speaks a text in place of the one before, where the person wants that
 */
export function attachSpeech(settings, option, settleMs = 0) {
  let said = "";
  let waiting = 0;
  return (text) => {
    const { [option]: wanted, speakVolume } = settings.values;
    if (!wanted || text === said || !("speechSynthesis" in window)) {
      if (!wanted) said = "";
      return;
    }
    said = text;
    clearTimeout(waiting);
    if (!settleMs) speechSynthesis.cancel();
    if (text === "") return;
    const utterance = new SpeechSynthesisUtterance(text);
    utterance.lang = document.documentElement.lang;
    utterance.volume = speakVolume;
    if (settleMs) waiting = setTimeout(() => speechSynthesis.speak(utterance), settleMs);
    else speechSynthesis.speak(utterance);
  };
}
