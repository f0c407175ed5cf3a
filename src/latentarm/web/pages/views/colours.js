/** The page's colours, as the style sheet has them now, for what is drawn by other means. */

/** @param {string} name of a custom property, without its dashes @returns {string} */
export function colour(name) {
  const probe = document.createElement("i");
  probe.style.color = `var(--${name})`;
  document.body.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}
