/** Text that is longer than its field takes is refused with a sentence; browsers would cut it in silence. */

import { say } from "./words.js";

/**
 * Whether text fits into a field in place of what is selected there.
 *
 * @param {Pick<HTMLInputElement, "value" | "maxLength" | "selectionStart" | "selectionEnd">} field @param {string} text
 */
export function fits({ value, maxLength, selectionStart, selectionEnd }, text) {
  return maxLength < 0 || value.length - ((selectionEnd ?? 0) - (selectionStart ?? 0)) + text.length <= maxLength;
}

/** For every field of the page. */
export function attachTooLong() {
  document.addEventListener("beforeinput", (event) => {
    const field = event.target;
    if (!(field instanceof HTMLInputElement) || event.data === null) return;
    field.setCustomValidity("");
    if (fits(field, event.data)) return;
    event.preventDefault();
    field.setCustomValidity(say("layout.too_long", { count: field.maxLength }));
    field.reportValidity();
  });
  // What was refused is not there: it keeps nothing from being sent.
  for (const type of ["keydown", "focusout"]) {
    document.addEventListener(type, ({ target }) => target instanceof HTMLInputElement && target.setCustomValidity(""));
  }
}
