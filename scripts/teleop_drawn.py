"""How long it takes from a press in the browser until the arm's motion is drawn in it.

Server and browser are on this machine. Each input is an arrow key, timed by the browser's own event; motion
is drawn when a frame with another tool position has been handed to the graphics processor. Between inputs the
arm rests. A frame is finished when the graphics processor, or what stands in for it, has done its work; what
the browser takes to put it on a screen is not in there. For example:

    python scripts/teleop_drawn.py RUN --inputs 500 --out drawn.json
"""

import argparse
from pathlib import Path

import numpy as np
from playwright.sync_api import Page

from teleop_page import SOFTWARE_GL, USUAL_GL, VIEWPORT, chromium, enable, served, tell

KEYS = ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown")
HELD_MS = 250
RESTING_MS = 450

PARTS = (
    "pressed to sent",
    "sent to heard of motion",
    "heard to drawn",
    "pressed to drawn",
    "drawn to finished",
    "pressed to finished",
)

WATCH = """{
  let press = null;
  let heard = null;
  let drawn = null;
  const moved = (from, to) => from !== null && to.some((value, axis) => Math.abs(value - from[axis]) > 1e-6);
  window.delays = [];
  window.addEventListener("keydown", (event) => {
    if (event.code.startsWith("Arrow") && !event.repeat) press = { at: event.timeStamp };
  }, { capture: true });
  window.addEventListener("keyup", () => { press = null; }, { capture: true });
  const Socket = window.WebSocket;
  window.WebSocket = class extends Socket {
    constructor(...words) {
      super(...words);
      if (!this.url.endsWith("/drive")) return;
      this.addEventListener("message", ({ data }) => {
        const { type, tool } = JSON.parse(data);
        if (type !== "state") return;
        if (press?.sent && !press.heard && moved(heard, tool)) press.heard = performance.now();
        heard = tool;
      });
    }
    send(text) {
      super.send(text);
      const said = JSON.parse(text);
      const deflected = said.type === "input" && said.u.some(Boolean);
      if (press && !press.sent && deflected) press.sent = performance.now();
    }
  };
  const finished = (tell) => {
    const gl = document.getElementById("scene").getContext("webgl2");
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    const look = () => {
      if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) setTimeout(look, 1);
      else tell(performance.now());
    };
    gl.flush();
    setTimeout(look, 1);
  };
  document.addEventListener("arm-drawn", ({ detail: { tool } }) => {
    if (press?.heard && moved(drawn, tool)) {
      const { at, sent, heard: known } = press;
      const now = performance.now();
      press = null;
      finished((end) => {
        window.delays.push([sent - at, known - sent, now - known, now - at, end - now, end - at]);
      });
    }
    drawn = tool;
  });
}"""


def measure(page: Page, inputs: int) -> tuple[list[list[float]], int]:
    """`PARTS` of the inputs whose motion was drawn, ms, and how often the arm had to be enabled again."""
    enables = 0
    for number in range(inputs):
        if not page.locator("#status[data-phase=ready]").count():
            enable(page)
            enables += 1
            page.locator("#stick").focus()
            page.wait_for_timeout(RESTING_MS)
        key = KEYS[number % len(KEYS)]
        page.keyboard.down(key)
        page.wait_for_timeout(HELD_MS)
        page.keyboard.up(key)
        page.wait_for_timeout(RESTING_MS)
    return page.evaluate("delays"), enables


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--inputs", type=int, default=500)
    parser.add_argument("--hardware", action="store_true", help="draw with the graphics processor")
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    with served(given.run) as site, chromium(USUAL_GL if given.hardware else SOFTWARE_GL) as browser:
        page = browser.new_page(viewport=VIEWPORT)
        page.add_init_script(WATCH)
        page.goto(site.address)
        page.locator(".label").first.wait_for(state="attached")
        delays, enables = measure(page, given.inputs)
    figures = {
        "inputs": given.inputs,
        "drawn": len(delays),
        **{
            part: {
                "median_ms": round(float(np.median(times)), 1),
                "p95_ms": round(float(np.percentile(times, 95)), 1),
            }
            for part, times in zip(PARTS, np.transpose(delays), strict=True)
        },
        "enabled_again": max(enables - 1, 0),
        "software_drawing": not given.hardware,
    }
    tell(figures, given.out)


if __name__ == "__main__":
    main()
