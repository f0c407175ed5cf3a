/** How finely round things are drawn: where there is no graphics processor, every triangle is the processor's work. */

/** Whether this computer draws without a graphics processor. */
export const SOFTWARE = drawsInSoftware();

/** Segments about an axis, from pole to pole, and of each cap of a capsule; and how often an icosahedron is divided. */
export const ROUND = SOFTWARE ? { about: 10, along: 6, cap: 2, divided: 0 } : { about: 24, along: 16, cap: 6, divided: 1 };

function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const about = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = about ? String(gl?.getParameter(about.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}
