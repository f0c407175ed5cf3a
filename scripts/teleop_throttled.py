"""How often the arm stops for want of inputs where the page's computer is slow.

Chromium's main thread is held up by a factor; a person drives to and fro with the arrow keys, and presses
Enable again whenever the arm has stopped. Counted are the stops because no input came in time, per minute in
which the arm was enabled. Anything else at work on this machine makes the figures larger. For example:

    python scripts/teleop_throttled.py RUN --rates 1 2 4 6 --minutes 1 --out throttled.json
"""

import argparse
import json
import threading
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from teleop_page import chromium, served

TURN_S = 1.0
"""How long each arrow key is held, s."""

LOOK_MS = 50
VIEWPORT = {"width": 1280, "height": 720}
FRAMES = (
    "window.frames_drawn = 0; document.addEventListener('arm-drawn', () => { window.frames_drawn += 1; });"
)


class Watcher:
    """What the server says of the arm: how long it was enabled, and why it stopped.

    Attributes:
        state: the newest.
        enabled_s: how long it was enabled, s.
        stops: when it stopped, s of the monotonic clock, and the code of the reason.
    """

    def __init__(self) -> None:
        self.state: dict[str, Any] = {}
        self.enabled_s = 0.0
        self.stops: list[tuple[float, str]] = []

    @property
    def enabled(self) -> bool:
        """Whether the arm may move."""
        return self.state.get("phase") in ("ready", "moving")

    def listen(self, socket: ClientConnection) -> None:
        """Follow the states until the connection ends."""
        since_s = time.monotonic()
        with suppress(ConnectionClosed):
            for frame in socket:
                message = json.loads(frame)
                if message["type"] != "state":
                    continue
                now_s, before = time.monotonic(), self.enabled
                self.state = message
                self.enabled_s += (now_s - since_s) if before else 0.0
                since_s = now_s
                if before and not self.enabled and message["reason"] is not None:
                    self.stops.append((round(now_s, 2), message["reason"]["code"]))


def drive(browser: Browser, address: str, rate: float, minutes: float) -> dict[str, Any]:
    """Drive for so long with the main thread slowed down by a factor.

    Args:
        browser: opens the page.
        address: of the page.
        rate: the factor; 1 for none.
        minutes: how long.

    Returns:
        The figures.
    """
    watcher = Watcher()
    page = browser.new_page(viewport=VIEWPORT)
    page.add_init_script(FRAMES)
    page.goto(address)
    page.locator("#status[data-phase=disengaged]").wait_for()
    page.locator(".label").first.wait_for(state="attached")
    session = page.context.new_cdp_session(page)
    session.send("Emulation.setCPUThrottlingRate", {"rate": rate})
    with connect(f"{address.replace('http', 'ws', 1)}/drive", origin=address, compression=None) as socket:
        listener = threading.Thread(target=watcher.listen, args=[socket], daemon=True)
        listener.start()
        socket.send(json.dumps({"type": "hello", "version": 1, "name": "counts"}))
        began_s = time.monotonic()
        drawn = page.evaluate("frames_drawn")
        presses = to_and_fro(page, watcher, began_s + 60.0 * minutes)
        took_s = time.monotonic() - began_s
        drawn = page.evaluate("frames_drawn") - drawn
    listener.join()
    page.context.close()
    stops = Counter(code for _, code in watcher.stops)
    late = stops["input_late"]
    return {
        "rate": rate,
        "enabled_s": round(watcher.enabled_s, 1),
        "late_stops": late,
        "late_stops_per_minute": round(60.0 * late / watcher.enabled_s, 1) if watcher.enabled_s else None,
        "presses_of_enable": presses,
        "frames_per_second": round(drawn / took_s, 1),
        "stops": dict(stops),
    }


def to_and_fro(page: Page, watcher: Watcher, until_s: float) -> int:
    """Hold the left and the right arrow key in turn; how often Enable was pressed."""
    presses = 0
    keys = ("ArrowLeft", "ArrowRight")
    turn = 0
    while time.monotonic() < until_s:
        if not watcher.enabled:
            presses += 1
            page.keyboard.press("Enter")
            wait(page, lambda: watcher.enabled, 2.0)
            continue
        key = keys[turn % 2]
        turn += 1
        page.keyboard.down(key)
        wait(page, lambda: not watcher.enabled, TURN_S)
        page.keyboard.up(key)
    return presses


def wait(page: Page, until: Callable[[], bool], within_s: float) -> None:
    """Let the page go on until something is so, and no longer than a while, s."""
    end_s = time.monotonic() + within_s
    while time.monotonic() < end_s and not until():
        page.wait_for_timeout(LOOK_MS)


def main() -> None:
    """Print the figures, and write them where asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--rates", type=float, nargs="+", default=[1.0, 2.0, 4.0, 6.0])
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--out", type=Path)
    given = parser.parse_args()
    found = []
    with chromium() as browser, served(given.run) as site:
        for rate in given.rates:
            found.append(drive(browser, site.address, rate, given.minutes))
            print(json.dumps(found[-1]), flush=True)
    if given.out is not None:
        given.out.write_text(json.dumps(found, indent=2) + "\n")


if __name__ == "__main__":
    main()
