/** Nothing moves behind a dialog: however one opens, the arm stops. */

/** @import {DriveInput} from "./drive_input.js" */

/** Whether any dialog is open. */
export function dialogIsOpen() {
  return [...document.getElementsByTagName("dialog")].some(({ open }) => open);
}

/**
 * Watches every dialog of the page, also those that are added later: whatever opens one, it sets the attribute.
 *
 * @param {Pick<DriveInput, "halt">} input
 */
export function attachDialogs(input) {
  let was = dialogIsOpen();
  new MutationObserver(() => {
    const is = dialogIsOpen();
    if (is && !was) input.halt("dialog_opened");
    was = is;
  }).observe(document.documentElement, { attributes: true, attributeFilter: ["open"], childList: true, subtree: true });
}
