"""How long it takes from opening the page until the arm can first be moved from it.

Each try opens the page with nothing kept from earlier ones. A script in it presses Enable as soon as that can
be pressed, and again where the arm has stopped before it moved, then holds an arrow key, and waits for the
first state in which the tool has moved. Times are from the start of the navigation. Server and browser are on
this machine. For example:

    python scripts/teleop_first_motion.py RUN --tries 10
"""

import argparse
import time
from pathlib import Path

import numpy as np
from playwright.sync_api import Browser

from teleop_page import VIEWPORT, chromium, served, tell

LOOK_MS = 100
PATIENCE_S = 60.0
"""For so long a computer may take until the arm moves: a busy one stops it again and again."""

STEPS = ("connected", "enabled", "moved", "views drawn")

PRESS = """{
  window.times = {};
  window.presses = 0;
  const once = (name) => { window.times[name] ??= performance.now(); };
  let pressed = -Infinity;
  let first = null;
  const Socket = window.WebSocket;
  window.WebSocket = class extends Socket {
    constructor(...words) {
      super(...words);
      this.addEventListener("message", ({ data }) => {
        const { type, tool, phase } = JSON.parse(data);
        if (type !== "state") return;
        once("connected");
        const key = { code: "ArrowLeft", key: "ArrowLeft", bubbles: true };
        if (["ready", "moving"].includes(phase)) {
          once("enabled");
          if (first === null) document.body.dispatchEvent(new KeyboardEvent("keydown", key));
          first ??= tool;
          if (tool.some((value, axis) => Math.abs(value - first[axis]) > 1e-6)) once("moved");
        } else if (!("moved" in window.times) && performance.now() - pressed > 300) {
          document.body.dispatchEvent(new KeyboardEvent("keyup", key));
          window.presses += 1;
          pressed = performance.now();
          first = null;
          setTimeout(() => document.getElementById("enable").click());
        }
      });
    }
  };
  document.addEventListener("arm-drawn", () => once("views drawn"));
}"""


def opened(browser: Browser, address: str) -> tuple[list[float], int]:
    """When each of `STEPS` was reached, ms, and how often Enable was pressed."""
    page = browser.new_page(viewport=VIEWPORT)
    page.add_init_script(PRESS)
    page.goto(address, wait_until="commit")
    times: dict[str, float] = {}
    end_s = time.monotonic() + PATIENCE_S
    while missing := [step for step in STEPS if step not in times]:
        if time.monotonic() > end_s:
            said = page.locator("#status-text").inner_text()
            raise SystemExit(f"Not {', '.join(missing)} within {PATIENCE_S:g} s; the page says: {said}")
        page.wait_for_timeout(LOOK_MS)
        times = page.evaluate("times")
    presses = page.evaluate("presses")
    page.keyboard.press("Escape")
    page.wait_for_timeout(1000)
    page.context.close()
    return [times[step] for step in STEPS], presses


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--tries", type=int, default=10)
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    with served(given.run) as site, chromium() as browser:
        tries = [opened(browser, site.address) for _ in range(given.tries)]
    times = np.array([one for one, _ in tries])
    figures = {
        "tries": given.tries,
        **{
            step: {"median_ms": round(float(np.median(column))), "worst_ms": round(float(column.max()))}
            for step, column in zip(STEPS, times.T, strict=True)
        },
        "presses_of_enable": sum(presses for _, presses in tries),
    }
    tell(figures, given.out)


if __name__ == "__main__":
    main()
