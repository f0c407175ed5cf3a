"""How long it takes from a press in the browser until the arm's motion is drawn in it.

Server and browser are on this machine. Each input is an arrow key, timed by the browser's own event; motion
is drawn when a frame with another tool position has been handed to the graphics processor. Between inputs the
arm rests. For example:

    python scripts/teleop_drawn.py RUN --inputs 500 --out drawn.json
"""

import argparse
import json
import os
from pathlib import Path

import numpy as np
from playwright.sync_api import Page

from teleop_page import chromium, enable, served

KEYS = ("ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown")
HELD_MS = 250
RESTING_MS = 450

WATCH = """() => {
  let tool = null;
  let pressedAt = null;
  window.delays = [];
  window.addEventListener("keydown", (event) => {
    if (event.code.startsWith("Arrow") && !event.repeat) pressedAt = event.timeStamp;
  }, { capture: true });
  window.addEventListener("keyup", () => { pressedAt = null; }, { capture: true });
  document.addEventListener("arm-drawn", (event) => {
    const now = event.detail.tool;
    const moved = tool !== null && now.some((value, axis) => Math.abs(value - tool[axis]) > 1e-6);
    if (moved && pressedAt !== null) {
      window.delays.push(performance.now() - pressedAt);
      pressedAt = null;
    }
    tool = now;
  });
}"""


def measure(page: Page, inputs: int) -> tuple[list[float], int]:
    """Delays of the inputs whose motion was drawn, ms, and how often the arm had to be enabled again."""
    page.evaluate(WATCH)
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
    with served(given.run) as site, chromium(software=not given.hardware) as browser:
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(site.address)
        page.locator(".label").first.wait_for(state="attached")
        delays, enables = measure(page, given.inputs)
    figures = {
        "inputs": given.inputs,
        "drawn": len(delays),
        "median_ms": float(np.median(delays)),
        "p95_ms": float(np.percentile(delays, 95)),
        "enabled_again": max(enables - 1, 0),
        "software_drawing": not given.hardware,
        "cores": os.cpu_count(),
        "load_average": os.getloadavg()[0],
    }
    text = json.dumps(figures, indent=2)
    print(text)
    if given.out:
        given.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
