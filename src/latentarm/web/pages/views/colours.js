/** The page's colours, as the style sheet has them now, for what is drawn by other means. */

/** @param {string} name of a custom property, without its dashes @returns {string} */
export function colour(name) {
  const probe = document.createElement("i");
  probe.style.color = `var(--${name})`;
  // Where the system forces its colours on text, all of them would be the same.
  probe.style.setProperty("forced-color-adjust", "none");
  document.body.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}
