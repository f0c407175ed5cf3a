"""How long a page drives a simulated arm without a stop, and how the arm rests once the page is closed.

A stand-in from the tests stands for the arm: franky-sim, the xArm's server, or the server that speaks the
rosbridge protocol. `latentarm teleop` drives it, and a Chromium has its page. A scripted person holds one
arrow key after another, changes the pair of axes, opens and closes the hand, and presses Enable again after
each stop. The stand-in has real-time priority, and the Franka's catches up where this computer stood still,
because an arm's controller is a computer of its own. Times at which the page is closed and the arm is at rest
are those of the stand-in's clock. For example:

    python scripts/arm_page.py --arm franka --minutes 10 --tries 50

Run `scripts/machine_pauses.py` next to it to see which stops are those of a computer that stood still.
"""

import argparse
import json
import os
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, Final, Protocol, final

import numpy as np
from playwright.sync_api import Browser, Page
from websockets.sync.client import connect

import franka_endurance as franka
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.stillness import STILL_RAD_S
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from ros2_endurance import ServerProcess, Setup
from teleop_page import NO_GL, VIEWPORT, chromium, enable, served, tell
from teleop_throttled import Watcher, wait
from xarm_endurance import XArmServer, serving, xarm7

BACK: Final = {
    "ArrowUp": "ArrowDown",
    "ArrowDown": "ArrowUp",
    "ArrowLeft": "ArrowRight",
    "ArrowRight": "ArrowLeft",
}
ARROWS: Final = tuple(BACK)
OTHER_AXES, HAND, ENABLE = "m", "g", "Enter"
OTHER_AXES_SHARE, HAND_SHARE = 0.3, 0.15
"""How often a new arrow key comes with another pair of axes, and with the hand."""

HELD_S: Final = (0.4, 1.0)
AGAIN_S: Final = 2.0
MOVES_WITHIN_S: Final = 5.0
PRIORITY: Final = 20
"""Of the stand-in, above that of the process which drives the arm."""

CATCHES_UP_S: Final = 0.1
"""How much the simulated Franka makes up for where this computer stood still. One that lost that time would
not have made the motion that was commanded: to the driver it would lag behind."""

FLOOR: Final = """
[keep_out.floor]
shape = "half_space"
point_m = [0.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
"""
"""franky-sim has one, and random keys would press the hand onto it."""

XARM_FILES: Final = Path(__file__).parents[1] / "tests" / "arms"
XARM_SPEED: Final = ("--joint-speed", "0.4")
XARM_GRIPPER: Final = """
[gripper]
joints = []
width_m = 0.085
speed_m_per_s = 0.1
force_n = 30
"""


class SimulatedArm(Protocol):
    """A stand-in for an arm, as this script needs it.

    Attributes:
        options: words that tell `latentarm teleop` to drive it.
        pid: of its process.
    """

    options: Sequence[str]
    pid: int

    def now_s(self) -> float:
        """Its clock, s."""
        ...

    def positions(self) -> FloatArray:
        """Where the joints are, (n,), rad."""
        ...

    def watch(self) -> None:
        """Keep from now on what the arm does."""
        ...

    def rested(self, at_s: float) -> dict[str, float]:
        """How it came to rest after a fault at a time of its clock, s."""
        ...


@final
class FrankaArm:
    """franky-sim.

    Args:
        folder: for its floor and its log.
        stand_in: its process.
    """

    def __init__(self, folder: Path, stand_in: franka.FrankaStandIn) -> None:
        zones = folder / "zones.toml"
        zones.write_text(FLOOR)
        self.options = ("--arm", franka.ADDRESS, "--robot", "fr3", "--zones", str(zones))
        self._log = folder / "log.npy"
        self._stand_in = stand_in
        self.pid: int = stand_in.pid

    def now_s(self) -> float:
        """See `SimulatedArm`."""
        return self._stand_in.time_s()

    def positions(self) -> FloatArray:
        """See `SimulatedArm`."""
        return self._stand_in.positions()

    def watch(self) -> None:
        """See `SimulatedArm`."""
        self._stand_in.ask("log")

    def rested(self, at_s: float) -> dict[str, float]:
        """See `SimulatedArm`."""
        self._stand_in.ask(f"save {self._log}")
        return franka.measured(np.load(self._log), at_s)


@final
class Ros2Arm:
    """A Panda behind the server that speaks the rosbridge protocol.

    Args:
        robot: what it is.
        server: its process.
    """

    def __init__(self, robot: Robot, server: ServerProcess) -> None:
        self._robot = robot
        self._server = server
        self.pid = server.pid
        self.options = ("--arm", server.address, "--robot", "panda")

    def now_s(self) -> float:
        """See `SimulatedArm`."""
        return time.monotonic()

    def positions(self) -> FloatArray:
        """See `SimulatedArm`."""
        return self._server.ask("positions")

    def watch(self) -> None:
        """See `SimulatedArm`."""
        self._server.take_trace()

    def rested(self, at_s: float) -> dict[str, float]:
        """See `SimulatedArm`."""
        return at_rest(self._robot, *self._server.take_trace(), at_s)


@final
class XArm7:
    """An xArm 7 behind the server that speaks its protocol.

    Args:
        folder: for its limits.
        robot: what it is.
        server: its process.
    """

    def __init__(self, folder: Path, robot: Robot, server: XArmServer) -> None:
        limits = folder / "limits.toml"
        limits.write_text((XARM_FILES / "xarm7.toml").read_text() + XARM_GRIPPER)
        self._robot = robot
        self._server = server
        self._since_s = 0.0
        self.pid = server.pid
        model = str(XARM_FILES / "xarm7.xml")
        self.options = ("--arm", server.address(), "--robot", model, "--limits", str(limits), *XARM_SPEED)

    def now_s(self) -> float:
        """See `SimulatedArm`."""
        return time.monotonic()

    def positions(self) -> FloatArray:
        """See `SimulatedArm`."""
        return np.array(self._server.do("state")["q"][: self._robot.dof])

    def watch(self) -> None:
        """See `SimulatedArm`."""
        self._since_s = time.monotonic()

    def rested(self, at_s: float) -> dict[str, float]:
        """See `SimulatedArm`."""
        rows = self._server.do("trace", since_s=self._since_s)
        return at_rest(
            self._robot, np.array([row[0] for row in rows]), np.array([row[1] for row in rows]), at_s
        )


def at_rest(robot: Robot, times: FloatArray, q: FloatArray, at_s: float) -> dict[str, float]:
    """How an arm came to rest, from where its joints were.

    Args:
        robot: what it is.
        times: (T,), s.
        q: (T, n), rad.
        at_s: when something was broken, s.

    Returns:
        ``rest_ms``, and ``crept_mm``: how far its tool got from where it was at rest.
    """
    speeds = np.abs(np.diff(q, axis=0)).max(axis=1) / np.diff(times)
    moving = np.flatnonzero((speeds > STILL_RAD_S) & (times[1:] >= at_s))
    rested = int(moving[-1]) + 1 if len(moving) else int(np.searchsorted(times, at_s))
    tool = robot.chain.forward(q[rested:]).position
    return {
        "rest_ms": 1e3 * float(max(0.0, times[rested] - at_s)),
        "crept_mm": 1e3 * float(np.linalg.norm(tool - tool[0], axis=1).max()),
        "speed_rad_s": float(speeds[max(0, int(np.searchsorted(times, at_s)) - 2)]),
    }


@contextmanager
def standing_in(arm: str, folder: Path) -> Iterator[SimulatedArm]:
    """A running stand-in.

    Args:
        arm: ``"franka"``, ``"ros2"`` or ``"xarm"``.
        folder: for its files.
    """
    with ExitStack() as stack:
        match arm:
            case "franka":
                stand_in = stack.enter_context(franka.FrankaStandIn(franka.HOST, catches_up_s=CATCHES_UP_S))
                found: SimulatedArm = FrankaArm(folder, stand_in)
            case "ros2":
                robot = panda()
                found = Ros2Arm(robot, stack.enter_context(ServerProcess(robot, Setup())))
            case _:
                robot = xarm7()
                server = stack.enter_context(serving(q=robot.home.tolist()))
                found = XArm7(folder, robot, server)
        for thread in Path(f"/proc/{found.pid}/task").iterdir():
            os.sched_setscheduler(int(thread.name), os.SCHED_RR, os.sched_param(PRIORITY))
        yield found


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
) -> tuple[list[dict[str, Any]], list[float]]:
    """Drive by the keyboard until a time of this computer's.

    Returns:
        What stopped the arm and where its tool was then, and the openings of the hand that were seen, m.
    """
    stops: list[dict[str, Any]] = []
    widths: list[float] = []
    while time.monotonic() < until_s:
        if not watcher.enabled:
            stops.append({name: watcher.state.get(name) for name in ("reason", "tool")})
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
    return stops, widths


def endure(browser: Browser, address: str, arm: SimulatedArm, minutes: float, seed: int) -> dict[str, Any]:
    """Drive for so long, and count what stops the arm."""
    watcher = Watcher()
    page = opened(browser, address)
    with connect(f"{address.replace('http', 'ws', 1)}/drive", origin=address, compression=None) as states:
        listener = threading.Thread(target=watcher.listen, args=[states], daemon=True)
        listener.start()
        states.send(json.dumps({"type": "hello", "version": 1, "name": "counts"}))
        began_s, arm_s = time.monotonic(), arm.now_s()
        until_s, rng = began_s + 60.0 * minutes, np.random.default_rng(seed)
        found, widths = hold_keys(page, watcher, until_s, rng)
        took_s, arm_s = time.monotonic() - began_s, arm.now_s() - arm_s
    listener.join()
    page.close()
    return {
        "seconds": round(took_s, 1),
        "arm_s": round(arm_s, 1),
        "enabled_s": round(watcher.enabled_s, 1),
        "stops": watcher.stops,
        "presses_of_enable_after": found,
        "hand_mm": [round(1e3 * min(widths), 1), round(1e3 * max(widths), 1)],
        "deadlines_met": round(1.0 - watcher.state["late_share"], 5),
    }


def close_page(browser: Browser, address: str, arm: SimulatedArm, arrow: str) -> dict[str, float]:
    """Close the page while a key is held; a new page then enables the arm, and drives it back."""
    page = opened(browser, address)
    enable(page)
    page.keyboard.down(arrow)
    page.wait_for_timeout(1e3 * franka.DRIVE_S)
    arm.watch()
    page.wait_for_timeout(100)
    at_s = arm.now_s()
    page.close()
    end_s = arm.now_s() + 2.0 * franka.QUIET_S
    while arm.now_s() < end_s:
        time.sleep(0.01)
    found = arm.rested(at_s)
    page = opened(browser, address)
    before = arm.positions()
    enable(page)
    page.keyboard.down(BACK[arrow])
    found["moves_when_enabled"] = float(moves(arm, before))
    page.keyboard.up(BACK[arrow])
    page.close()
    return found


def moves(arm: SimulatedArm, before: FloatArray) -> bool:
    """Whether the arm goes anywhere soon."""
    end_s = time.monotonic() + MOVES_WITHIN_S
    while time.monotonic() < end_s:
        if (np.abs(arm.positions() - before) > 1e-3).any():
            return True
        time.sleep(0.05)
    return False


def main() -> None:
    """Print the figures, and write them where asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--arm", choices=("franka", "ros2", "xarm"), default="franka")
    parser.add_argument("--minutes", type=float, default=10.0, help="of driving")
    parser.add_argument("--tries", type=int, default=50, help="of closing the page")
    parser.add_argument("--seed", type=int, default=0, help="of the keys")
    parser.add_argument("--out", type=Path, help="file for the figures")
    chosen = parser.parse_args()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        arm = stack.enter_context(standing_in(chosen.arm, folder))
        site = stack.enter_context(served(None, options=arm.options))
        browser = stack.enter_context(chromium(NO_GL))
        figures: dict[str, object] = {"arm": chosen.arm, "seed": chosen.seed}
        # First, because random keys leave the arm where not every arrow moves it.
        if chosen.tries:
            arrows = np.random.default_rng(chosen.seed).choice(ARROWS, chosen.tries)
            tries = [close_page(browser, site.address, arm, str(arrow)) for arrow in arrows]
            figures["page closed"] = franka.summary(tries)
        if chosen.minutes:
            figures["driving"] = endure(browser, site.address, arm, chosen.minutes, chosen.seed)
        tell(figures, chosen.out)


if __name__ == "__main__":
    main()
