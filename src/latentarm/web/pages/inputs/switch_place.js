/** The switches stand in their place on the page, or, where that is out of sight, in a bar: of what is open, or at the foot. */

import { byId, create, setHidden } from "../layout/dom.js";

/** The heights of the switches and of their list until they have been measured, px. */
const GUESSED = { panel: 240, list: 120 };

/** @returns {(on: boolean, open: HTMLElement | null) => void} puts the switches where they are seen: with what is open above the page */
export function attachSwitchPlace() {
  const bar = byId("page-switch");
  const panel = byId("panel-switch");
  const list = byId("scan");
  /** Keeps the place on the page while the switches are in the bar. */
  const place = create("div");
  let { list: listPx } = GUESSED;

  const inBar = () => panel.parentElement === bar;
  const inSight = () => {
    const here = inBar() ? place : panel;
    if (!inBar()) listPx = list.offsetTop + list.offsetHeight - panel.offsetTop || listPx;
    const { left, top, width } = here.getBoundingClientRect();
    return width > 0 && [top + 1, top + listPx - 1].every((y) => here.contains(document.elementFromPoint(left + width / 2, y)));
  };
  return (on, open) => {
    setHidden(panel, !on);
    const atHome = !on || (!open && inSight());
    if (atHome) place.replaceWith(panel);
    else if (!inBar()) {
      place.style.height = `${panel.offsetHeight || GUESSED.panel}px`;
      panel.replaceWith(place);
      bar.append(panel);
    }
    if (open && bar.parentElement !== open) open.append(bar);
    if (!open && bar.parentElement !== document.body) byId("main").after(bar);
    setHidden(bar, !on || !inBar());
  };
}
