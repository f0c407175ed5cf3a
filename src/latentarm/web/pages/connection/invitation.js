/** The host lets the next person in: a link that works once, to read with a phone. */

import { byId, setText } from "../layout/dom.js";

const WHERE = "/invitation";

/** The page of the person who started the server may invite; on other pages nothing of it is seen. */
export async function attachInvitation() {
  const shown = byId("invited");
  byId("invite").addEventListener("click", async () => {
    // A new link each time: one that has been used, or has been shown to somebody else, works no more.
    const { link, size, path } = await (await fetch(WHERE, { method: "POST" })).json();
    draw(size, path);
    setText(byId("invitation-link"), link);
    shown.hidden = false;
    shown.scrollIntoView({ block: "nearest" });
  });
  byId("invited-done").addEventListener("click", () => {
    shown.hidden = true;
    byId("invite").focus();
  });
  try {
    const { may } = await (await fetch(WHERE)).json();
    byId("invitation").hidden = !may;
  } catch {
    // The server has gone: the page says so elsewhere.
  }
}

/** @param {number} size modules from edge to edge @param {string} path its dark modules */
function draw(size, path) {
  const code = /** @type {SVGElement} */ (/** @type {unknown} */ (document.getElementById("invitation-code")));
  code.setAttribute("viewBox", `0 0 ${size} ${size}`);
  code.querySelector("path")?.setAttribute("d", path);
}
