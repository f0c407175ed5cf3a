"""How long a page drives a simulated Franka without a stop, and how the arm rests once the page is closed.

franky-sim (see `tests/stand_ins/franka_server.py`) stands for the arm, `latentarm teleop` drives it, and a
Chromium has its page. A scripted person holds one arrow key after another, changes the pair of axes, opens
and closes the hand, and presses Enable again after each stop. The times of the arm are those of its own
clock; the others are this computer's. The simulator has real-time priority, because the arm's controller is
a computer of its own. For example:

    python scripts/franka_page.py --minutes 10 --tries 50
"""

import argparse
import json
import os
import tempfile
import threading
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final

import numpy as np
from playwright.sync_api import Browser, Page
from websockets.sync.client import connect

from franka_endurance import (
    ADDRESS,
    DRIVE_S,
    HOST,
    QUIET_S,
    ArmClock,
    FrankaStandIn,
    measured,
    moves,
    summary,
)
from teleop_page import NO_GL, VIEWPORT, chromium, enable, served, tell
from teleop_throttled import Watcher, wait

ARROWS: Final = ("ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight")
OTHER_AXES, HAND, ENABLE = "m", "g", "Enter"
OTHER_AXES_SHARE, HAND_SHARE = 0.3, 0.15
"""How often a new arrow key comes with another pair of axes, and with the hand."""

HELD_S: Final = (0.4, 1.0)
AGAIN_S: Final = 2.0
PRIORITY: Final = 20
"""Of the simulator, above that of the process which drives the arm."""


def opened(browser: Browser, address: str) -> Page:
    """A page on which the points before a real arm moves are confirmed."""
    page = browser.new_page(viewport=VIEWPORT)
    page.goto(address)
    page.locator("#status[data-phase=disengaged]").wait_for()
    for box in page.locator("#checklist input").all():
        box.check()
    page.evaluate("document.activeElement.blur()")
    return page


def hold_keys(
    page: Page, watcher: Watcher, until_s: float, rng: np.random.Generator
) -> tuple[int, list[float]]:
    """Drive by the keyboard until a time of this computer's.

    Returns:
        How often Enable was pressed, and the openings of the hand that were seen, m.
    """
    presses = 0
    widths: list[float] = []
    while time.monotonic() < until_s:
        if not watcher.enabled:
            presses += 1
            page.keyboard.press(ENABLE)
            wait(page, lambda: watcher.enabled, AGAIN_S)
            continue
        if rng.random() < OTHER_AXES_SHARE:
            page.keyboard.press(OTHER_AXES)
        if rng.random() < HAND_SHARE:
            page.keyboard.press(HAND)
        arrow = str(rng.choice(ARROWS))
        page.keyboard.down(arrow)
        wait(page, lambda: not watcher.enabled, float(rng.uniform(*HELD_S)))
        page.keyboard.up(arrow)
        widths.append(watcher.state["gripper"]["width_m"])
    return presses, widths


def endure(browser: Browser, address: str, clock: ArmClock, minutes: float, seed: int) -> dict[str, Any]:
    """Drive for so long, and count what stops the arm."""
    watcher = Watcher()
    page = opened(browser, address)
    with connect(f"{address.replace('http', 'ws', 1)}/drive", origin=address, compression=None) as states:
        listener = threading.Thread(target=watcher.listen, args=[states], daemon=True)
        listener.start()
        states.send(json.dumps({"type": "hello", "version": 1, "name": "counts"}))
        began_s, arm_s = time.monotonic(), clock.now_s()
        presses, widths = hold_keys(page, watcher, began_s + 60.0 * minutes, np.random.default_rng(seed))
        took_s, arm_s = time.monotonic() - began_s, clock.now_s() - arm_s
    listener.join()
    page.close()
    return {
        "seconds": round(took_s, 1),
        "arm_s": round(arm_s, 1),
        "enabled_s": round(watcher.enabled_s, 1),
        "presses_of_enable": presses,
        "stops": watcher.stops,
        "hand_mm": [round(1e3 * min(widths), 1), round(1e3 * max(widths), 1)],
        "deadlines_met": round(1.0 - watcher.state["late_share"], 5),
    }


def close_page(
    browser: Browser, address: str, stand_in: FrankaStandIn, clock: ArmClock, log: Path, arrow: str
) -> dict[str, float]:
    """Close the page while a key is held; a new page then enables the arm."""
    page = opened(browser, address)
    enable(page)
    page.keyboard.down(arrow)
    page.wait_for_timeout(1e3 * DRIVE_S)
    stand_in.ask("log")
    page.wait_for_timeout(100)
    at_s = stand_in.time_s()
    page.close()
    stand_in.wait(2.0 * QUIET_S)
    stand_in.ask(f"save {log}")
    found = measured(np.load(log), at_s)
    page = opened(browser, address)
    before = stand_in.positions()
    enable(page)
    page.keyboard.down(arrow)
    found["moves_when_enabled"] = float(moves(stand_in, clock, before))
    page.keyboard.up(arrow)
    page.close()
    return found


def main() -> None:
    """Print the figures, and write them where asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0, help="of driving")
    parser.add_argument("--tries", type=int, default=50, help="of closing the page")
    parser.add_argument("--seed", type=int, default=0, help="of the keys")
    parser.add_argument("--out", type=Path, help="file for the figures")
    chosen = parser.parse_args()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        log = folder / "log.npy"
        clock_path = folder / "clock"
        np.zeros(1, np.int64).tofile(clock_path)
        stand_in = stack.enter_context(FrankaStandIn(HOST, clock_file=clock_path))
        os.sched_setscheduler(stand_in.pid, os.SCHED_RR, os.sched_param(PRIORITY))
        clock = ArmClock(clock_path)
        site = stack.enter_context(served(None, options=["--arm", ADDRESS, "--robot", "fr3"]))
        browser = stack.enter_context(chromium(NO_GL))
        figures: dict[str, object] = {"seed": chosen.seed}
        if chosen.minutes:
            figures["driving"] = endure(browser, site.address, clock, chosen.minutes, chosen.seed)
        if chosen.tries:
            arrows = np.random.default_rng(chosen.seed).choice(ARROWS, chosen.tries)
            tries = [close_page(browser, site.address, stand_in, clock, log, str(arrow)) for arrow in arrows]
            figures["page closed"] = {"tries": len(tries)} | summary(tries)
        tell(figures, chosen.out)


if __name__ == "__main__":
    main()
