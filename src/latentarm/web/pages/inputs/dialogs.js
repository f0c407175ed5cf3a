/** The dialog or menu above the page. Nothing moves behind a dialog: however one opens, the arm stops. */

/** The dialog or the menu above everything else: opening a dialog closes the menu. @returns {HTMLElement | null} */
export function topmost() {
  return document.querySelector(":is(dialog[open], :popover-open)");
}

export function dialogIsOpen() {
  return topmost()?.localName === "dialog";
}

/** Watches every dialog and menu of the page, also those that are added later. @param {(before: HTMLElement | null) => void} changed hears what was topmost */
export function watchOpen(changed) {
  let was = topmost();
  const look = () => {
    const [before, is] = [was, topmost()];
    was = is;
    if (is !== before) changed(before);
  };
  new MutationObserver(look).observe(document.documentElement, { attributes: true, attributeFilter: ["open"], childList: true, subtree: true });
  document.addEventListener("toggle", look, { capture: true });
}

/** @param {Pick<DriveInput, "halt">} input */
export function attachDialogs(input) {
  watchOpen((before) => {
    if (dialogIsOpen() && before?.localName !== "dialog") input.halt("dialog_opened");
  });
}
