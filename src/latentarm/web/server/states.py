"""The arm's state for pages: the newest report, made into one message for all."""

import asyncio
import json
import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np

from latentarm.robots.kinematics.pose_rows import STORED
from latentarm.web.protocol.notice import Notice, notice_of
from latentarm.web.protocol.report import ArmState, Ghosts, Report, Things
from latentarm.web.protocol.scene import pose_of
from latentarm.web.protocol.server_messages import CopilotState, Person, State
from latentarm.web.server.connected_pages import ConnectedPages, Page
from latentarm.web.server.loaded_run import Beginning, LoadedRun, RunList, beginning_of, load_reported_run

if TYPE_CHECKING:
    from latentarm.web.arm_process.process import ControlProcess

POLL_S: Final = 0.0025  # how often the report is read, s
SILENT_S: Final = 0.5  # a control process that is silent for so long is considered broken, s
NOTE_S: Final = 6.0  # how long a refusal is shown, s
AWAY_PERIOD_S: Final = 0.2  # how often pages receive the reason why there is no new report, s
_SAME_M: Final = 1e-3

_UNKNOWN: Final[dict[str, object]] = {
    "phase": "disengaged",
    "reason": None,
    "held_back": None,
    "zone": None,
    "returning": False,
    "bound_for": None,
}
"""What pages see of an arm of which there is no news."""


@final
class PageMemory:
    """The ghosts and things that a page was sent last, so that it is sent only changes."""

    def __init__(self) -> None:
        self._ghosts: Ghosts | None = None
        self._things: Things | None = None

    def new_ghosts(self, ghosts: Ghosts) -> bool:
        """Whether any has appeared, gone or moved by more than 1 mm; if so they are remembered."""
        before = self._ghosts
        if ghosts == before:
            return False
        if before is not None and len(before.ring) == len(ghosts.ring) and _moved(before, ghosts) < _SAME_M:
            return False
        self._ghosts = ghosts
        return True

    def new_things(self, things: Things) -> bool:
        """Whether any has moved; if so it is remembered."""
        before, self._things = self._things, things
        return things is not before and things != before


@final
@dataclass(eq=False)
class States:
    """The newest state of the arm, for pages to wait for."""

    loaded: LoadedRun  # the setup that is driven
    _control: "ControlProcess"
    _sessions: ConnectedPages
    _run_list: RunList

    def __post_init__(self) -> None:
        self.standstill: Notice | None = None  # why the arm may not be enabled; None if it may
        self.heard: list[Callable[[Report], None]] = []  # called with every report about `loaded`
        self.loading = False  # whether another setup is being loaded, here or in the control process
        self._failed: tuple[Beginning, Notice] | None = None
        self._changing: asyncio.Task[None] | None = None
        self.report: Report | None = None  # the newest about `loaded`; None before the first
        self._heard_s = time.monotonic()
        self.trail = 0  # counts how often the trail was emptied on every page
        # counts how often the connection to the arm was lost: what was confirmed before counts no more
        self.arm_start = 0
        self._changed = asyncio.Event()
        self._set_off = asyncio.Event()
        self._note: Notice | None = None
        self._note_until_s = -math.inf
        self._moves = False
        self._number = 0
        self._things: Things | None = None
        self._cache: tuple[int, dict[tuple[bool, bool], str]] = (-1, {})

    async def follow(self) -> None:
        """Read new reports until cancelled, and wake the callers of `after`."""
        told_s = -math.inf
        while True:
            report = self._control.newest()
            now_s = time.monotonic()
            if report is not None:
                self._heard_s = now_s
                self._take(report)
            # Pages without messages would assume that the server is dead, so the reason is repeated.
            if self.away is not None:
                if now_s - told_s > AWAY_PERIOD_S:
                    told_s = now_s
                    self._wake()
            elif report is not None:
                self._wake()
            await asyncio.sleep(POLL_S)

    async def after(self, number: int) -> int:
        """Wait for a state newer than this number, and return the newest one's number."""
        while self._number <= number or self.report is None:
            await self._changed.wait()
        return self._number

    async def pause(self, span_s: float) -> None:
        """Wait for this long, s, or until the arm starts to move."""
        with suppress(TimeoutError):
            async with asyncio.timeout(span_s):
                await self._set_off.wait()

    def say(self, note: Notice | None, for_s: float = NOTE_S) -> None:
        """Show every page a note instead of the arm's state for this long, s; None removes it."""
        self._note = note
        self._note_until_s = time.monotonic() + for_s

    @property
    def quiet_s(self) -> float:
        """For how long there has been no report, s."""
        return time.monotonic() - self._heard_s

    @property
    def away(self) -> Notice | None:
        """Why there is no news of the arm; None if there is."""
        return self._why_away() if self.loading or self.quiet_s > SILENT_S else None

    @property
    def at_rest(self) -> bool:
        """True while the arm is disengaged and at rest."""
        return self.report is not None and self.report.phase in ("disengaged", "neutral_needed")

    def journal(self) -> Path | None:
        """The journal that is or was last recorded to; None if nothing ever was."""
        journal = None if self.report is None else self.report.journal
        return None if journal is None else Path(journal)

    def text(self, page: Page, shown: PageMemory) -> str:
        """The newest state as JSON, for a page."""
        report = self.report
        if report is None:
            raise RuntimeError("there is no report yet")
        ghosts = report.ghosts is not None and shown.new_ghosts(report.ghosts)
        things = self._things is not None and shown.new_things(self._things)
        drives = self._sessions.drives(page)
        number, texts = self._cache
        if number != self._number:
            texts = {}
            self._cache = (self._number, texts)
        new = ghosts, things
        if new not in texts:
            state = self._state(report, ghosts=ghosts, things=things)
            texts[new] = state.model_dump_json(exclude={"you"})[:-1]
        return f'{texts[new]},"you":{json.dumps(drives)}}}'

    def _take(self, report: Report) -> None:
        """Keep a report; if it is about another run or beginning, load that first."""
        if self.loaded.shows(report):
            moved = self.report is not None and _rounded(report.tool) != _rounded(self.report.tool)
            if moved and not self._moves:
                self._set_off.set()
                self._set_off.clear()
            self._moves = moved
            if report.lost and not (self.report is not None and self.report.lost):
                self.arm_start += 1
            self.report = report
            self._things = report.things or self._things
            self.loading = report.loading
            self._failed = None
            for hear in self.heard:
                hear(report)
        elif self._changing is None and (self._failed is None or self._failed[0] != beginning_of(report)):
            self._failed = None
            self.loading = True
            self._changing = asyncio.create_task(self._change(report))

    async def _change(self, report: Report) -> None:
        name = self._run_list.name_of(None if report.run is None else Path(report.run))
        try:
            self.loaded = await asyncio.to_thread(load_reported_run, self.loaded.spec, report, name)
            self.report = report
            self._things = None
        except Exception as error:  # noqa: BLE001 - otherwise pages would wait for ever
            self._failed = beginning_of(report), notice_of(error)
        finally:
            self._changing = None

    def _wake(self) -> None:
        self._number += 1
        self._changed.set()
        self._changed.clear()

    def _state(self, report: Report, *, ghosts: bool, things: bool) -> State:
        driver, asking = self._sessions.driver, self._sessions.asking
        would = self._sessions.named(self._sessions.copilot.asking)
        away = self.away
        arm: dict[str, Any] = {name: getattr(report, name) for name in ArmState.model_fields}
        if away is not None:
            arm |= _UNKNOWN | {"guiding": "offered" if report.guiding == "on" else report.guiding}
        arm |= {
            "note": away or self._shown_note(report),
            "tool": _rounded(report.tool),
            "things": self._things if things else None,
            "ghosts": report.ghosts if ghosts else None,
            "alpha": round(report.alpha, 3),
            "late_share": round(report.late_share, 5),
        }
        if report.gripper is not None:
            width_m = round(report.gripper.width_m, 4)
            arm["gripper"] = report.gripper.model_copy(update={"width_m": width_m})
        return State(
            **arm,
            bodies=self._bodies(report),
            belief=tuple(round(share, 4) for share in report.belief) or None,
            driver=None if driver is None else driver.id,
            driver_name=None if driver is None else driver.name,
            watchers=self._sessions.count - (driver is not None),
            asking=None if asking is None else asking.id,
            asking_name=None if asking is None else asking.name,
            copilot=self._copilot(),
            copilot_asking=None if would is None else Person(id=would.id, name=would.name),
            trail=self.trail,
            arm_start=self.arm_start,
            you=False,
        )

    def _copilot(self) -> CopilotState | None:
        copilot = self._sessions.copilot
        page = self._sessions.named(copilot.page)
        if page is None or copilot.paced is None:
            return None
        return CopilotState(id=page.id, name=page.name, pace=round(copilot.paced.pace, 2))

    def _shown_note(self, report: Report) -> Notice | None:
        if self._note is not None and time.monotonic() < self._note_until_s and report.phase != "stopping":
            return self._note
        disengaged = report.phase in ("disengaged", "neutral_needed")
        return self.standstill if disengaged and self.standstill is not None else report.note

    def _why_away(self) -> Notice:
        if not self._control.alive:
            return Notice(code="arm_process_ended")
        if not self.loading:
            return Notice(code="arm_process_silent")
        if self._failed is not None:
            return self._failed[1]
        connecting = self.report is not None and self.report.lost
        return Notice(code="reconnecting" if connecting else "loading_run")

    def _bodies(self, report: Report) -> tuple[tuple[float, ...], ...]:
        links = self.loaded.setup.task.robot.chain.link_transforms(np.array(report.q))
        frames = np.concatenate([np.eye(4)[None], links])
        return tuple(tuple(round(value, 4) for value in pose) for pose in pose_of(frames).tolist())


def _moved(before: Ghosts, after: Ghosts) -> float:
    """The largest change of any number: of the paths and the ring, m, and of the ring's quaternions.

    Two quaternions of opposite signs are one orientation: that of a tool that points down often changes sign.
    """
    ring, there = (np.reshape(one.ring, (-1, STORED)) for one in (before, after))
    sign = np.where(np.vecdot(ring[:, 3:], there[:, 3:]) < 0.0, -1.0, 1.0)[:, None]
    changes = [ring[:, :3] - there[:, :3], ring[:, 3:] - sign * there[:, 3:]]
    changes += [
        np.subtract(getattr(before, name), getattr(after, name)) for name in ("up", "down", "left", "right")
    ]
    return max(float(np.abs(change).max(initial=0.0)) for change in changes)


def _rounded(point: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = point
    return round(x, 4), round(y, 4), round(z, 4)
