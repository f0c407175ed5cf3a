"""Measure how long after a key press the page shows the push and the arm's response.

A real Chromium of 1280 by 720, which draws without a graphics processor, before a real server; arrow keys
push a simulated arm from rest. The push is shown when the browser presents the next frame, by its Event
Timing, in steps of 8 ms. The arm's response is shown when the drawing with the first motion is finished and
the frame with it has begun to be composed.
"""

import os
import tempfile
import time
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm_research.measurements.bare_chromium import Tab, browser
from latentarm_research.measurements.catalogue import PageLatency
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.page_stops import DRAWN, DRIVE_SOCKET, send, served

WITHIN_MS: Final = 60.0
HELD_S: Final = 0.35
REST_S: Final = (0.35, 0.55)
SCREEN: Final = {"width": 1280, "height": 720, "deviceScaleFactor": 1, "mobile": False}
ENABLED: Final = "document.querySelector('#status:is([data-phase=ready], [data-phase=moving])')"
KEYS: Final = {"ArrowRight": 39, "ArrowLeft": 37}

WATCH: Final = """{
  window.shown = { push: [], arm: [] };
  let pressedAt = null, rest = null, tool = null;
  addEventListener("keydown", (event) => {
    if (!event.repeat) [pressedAt, rest] = [event.timeStamp, tool];
  }, { capture: true });
  document.addEventListener("arm-drawn", ({ detail }) => {
    tool = detail.tool;
    if (pressedAt === null || rest === null) return;
    if (Math.hypot(...tool.map((to, axis) => to - rest[axis])) < 2e-5) return;
    const since = pressedAt;
    pressedAt = null;
    const gl = document.getElementById("scene").getContext("webgl2");
    const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const look = () => {
      const done = gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED;
      if (done) shown.arm.push(performance.now() - since);
      else setTimeout(look, 1);
    };
    requestAnimationFrame(() => setTimeout(look));
  });
  new PerformanceObserver((list) => {
    for (const entry of list.getEntries()) if (entry.name === "keydown") shown.push.push(entry.duration);
  }).observe({ type: "event", durationThreshold: 16 });
}"""


def measure(options: PageLatency, work: Work) -> Outcome:
    """Median, 95th percentile and worst until the push and until the arm's response is on the screen."""
    random = np.random.default_rng(work.seed)
    with (
        tempfile.TemporaryDirectory() as out,
        served(options.run, Path(out)) as (_, address),
        browser() as chromium,
    ):
        tab = chromium.open(address, DRIVE_SOCKET + WATCH)
        tab.ask("Emulation.setDeviceMetricsOverride", **SCREEN)
        if not tab.wait(DRAWN, 30.0):
            raise UserError(f"The page does not come up: {tab.evaluate('document.body.innerText')}"[:500])
        send(tab, "ask_to_drive")
        send(tab, "reset")
        presses = 0
        while presses < options.presses:
            presses += press(tab, tuple(KEYS.items())[presses % 2], random.uniform(*REST_S))
        shown: dict[str, list[float]] = tab.evaluate("shown")
    rows, broken = [], list[str]()
    for what, times_ms in shown.items():
        shares = {"median_ms": 50, "p95_ms": 95, "worst_ms": 100}
        figures = {word: float(np.percentile(times_ms, share)) for word, share in shares.items()}
        rows += line("page-latency", what, len(times_ms), {**figures, "load": os.getloadavg()[1]})
        broken += [f"{what}: p95 is more than {WITHIN_MS:g} ms"] * (figures["p95_ms"] > WITHIN_MS)
    return Outcome(rows, broken)


def press(tab: Tab, key: tuple[str, int], rest_s: float) -> bool:
    """Press a key for a while and let go, with the arm enabled; return whether the arm took it."""
    if not tab.evaluate(f"Boolean({ENABLED})"):
        tab.evaluate("document.getElementById('enable').click()")
        tab.wait(ENABLED, 1.5)
    time.sleep(rest_s)
    name, code = key
    before = tab.evaluate("shown.arm.length")
    event = {"key": name, "code": name, "windowsVirtualKeyCode": code}
    tab.ask("Input.dispatchKeyEvent", type="rawKeyDown", **event)
    time.sleep(HELD_S)
    tab.ask("Input.dispatchKeyEvent", type="keyUp", **event)
    return bool(tab.evaluate(f"shown.arm.length > {before}"))
