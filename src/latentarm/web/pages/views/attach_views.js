/** The two views of a page. They are loaded after the page works: they are large, and all else works without them. */

import { byId, setText, whenever } from "../layout/dom.js";
import { say } from "../layout/words.js";

/**
 * @param {Settings} settings
 * @param {string} without what is said where this browser cannot draw
 * @param {(drawing: Drawing) => void} loaded
 * @param {string} [where] address of the scene; that of what is driven now if left out
 */
export async function attachViews(settings, without, loaded, where = "") {
  const caption = /** @type {HTMLElement} */ (byId("view-front").querySelector("figcaption span"));
  const name = () => setText(caption, say(settings.values.seat === "facing" ? "views.front" : "views.shoulder"));
  whenever(settings, ["change"], name);
  const lost = () => {
    byId("scene-lost").hidden = false;
    setText(byId("scene-lost"), without);
  };
  try {
    const { Drawing } = await import("./drawing.js");
    const elements = { canvas: byId("scene", HTMLCanvasElement), front: byId("view-front"), side: byId("view-side") };
    const drawing = await Drawing.load(elements, where);
    elements.canvas.addEventListener("webglcontextlost", lost);
    elements.canvas.addEventListener("webglcontextrestored", () => {
      byId("scene-lost").hidden = true;
      drawing.restore();
    });
    loaded(drawing);
  } catch (error) {
    lost();
    console.error(error);
  }
}
