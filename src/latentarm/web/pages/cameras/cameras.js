/** The cameras instead of the drawn arm, as the person likes; loaded only where there are cameras. */

import { byId, setHidden, setText } from "../layout/dom.js";
import { sayNotice } from "../layout/words.js";
import { CameraLink } from "./camera_link.js";
import { CameraView } from "./camera_view.js";
import { ServerClock } from "./picture_age.js";

/** How often the age of the pictures is checked, ms. */
const LOOK_MS = 50;

/** @param {Settings} settings @param {Connection} connection @param {() => void} draw loads the drawn arm */
export function attachCameras(settings, connection, draw) {
  const [cameras, drawn, why] = ["cameras", "views", "cameras-why"].map((id) => byId(id));
  const clock = new ServerClock();
  const views = [.../** @type {NodeListOf<HTMLElement>} */ (cameras.querySelectorAll(".camera"))].map((figure) => new CameraView(figure, clock));
  const link = new CameraLink(views.length, clock, {
    track: (number, track) => views[number]?.show(track),
    told: (told) => told.forEach(({ state, rtp, at }, number) => {
      const view = views[number];
      view.state = state;
      if (rtp !== null && at !== null) view.dated = { rtp, at };
    }),
    refused: (notice) => {
      setHidden(why, notice === null);
      if (notice) setText(why, sayNotice(notice));
    },
  });

  let asked = false;
  const chosen = () => settings.values.picture === "camera";
  const choose = () => {
    setHidden(cameras, !chosen());
    setHidden(drawn, chosen());
    if (!chosen() && !asked) {
      asked = true;
      draw();
    }
    // Hidden pictures are not sent.
    link.want(chosen() && !document.hidden && connection.open ? connection.welcome?.id ?? null : null);
  };
  settings.addEventListener("change", choose);
  for (const event of ["welcome", "open"]) connection.addEventListener(event, choose);
  document.addEventListener("visibilitychange", choose);
  setInterval(() => {
    if (chosen()) for (const view of views) view.look(performance.now(), link.connected);
  }, LOOK_MS);
  choose();
}
