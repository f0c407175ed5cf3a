/** Light or dark: follows the system until the person chooses. */

import { byId, whenever } from "../layout/dom.js";

/** @param {Settings} settings @param {() => void} repaint */
export function attachTheme(settings, repaint) {
  const button = byId("theme");
  const system = matchMedia("(prefers-color-scheme: dark)");
  const show = () => {
    const { theme } = settings.values;
    const dark = theme === "auto" ? system.matches : theme === "dark";
    if (button.getAttribute("aria-pressed") === String(dark) && document.documentElement.dataset.theme) return;
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    button.setAttribute("aria-pressed", String(dark));
    repaint();
  };
  button.addEventListener("click", () => {
    const dark = document.documentElement.dataset.theme === "dark";
    settings.change({ theme: dark ? "light" : "dark" });
  });
  system.addEventListener("change", show);
  matchMedia("(forced-colors: active)").addEventListener("change", repaint);
  whenever(settings, ["change"], show);
}
