"""What the pages are told of the arm: the newest report, made into one message for all."""

import asyncio
import json
import time
from typing import Final, final

import numpy as np

from latentarm.types import FloatArray
from latentarm.web.channel import Ghosts, Report
from latentarm.web.messages import RecordingState, State
from latentarm.web.scene import pose_of
from latentarm.web.sessions import Page, Sessions
from latentarm.web.setting import Setting
from latentarm.web.supervisor import ControlProcess

POLL_S: Final = 0.005
"""How often the control process's slot is looked at, s."""

SILENT_S: Final = 0.5
"""A control process that says nothing for so long is out of order."""

_SAME_M: Final = 1e-3
_DEAD: Final = "The arm's control process has ended: start latentarm teleop again."
_SILENT: Final = "The arm's control process does not answer: the arm has stopped by itself."


@final
class GhostMemory:
    """What a page was shown last of the ghosts, so that it is told only of changes."""

    def __init__(self) -> None:
        self._shown: FloatArray | None = None

    def differs(self, ghosts: Ghosts) -> bool:
        """Whether any point has moved by more than 1 mm; if so it is remembered as shown."""
        points = np.array([ghosts.up, ghosts.down, ghosts.left, ghosts.right])
        if self._shown is not None and np.abs(points - self._shown).max() < _SAME_M:
            return False
        self._shown = points
        return True


@final
class States:
    """The newest state of the arm, for pages to wait for and to be sent.

    Args:
        setting: what is driven.
        control: the control process.
        sessions: who is there.
    """

    def __init__(self, setting: Setting, control: ControlProcess, sessions: Sessions) -> None:
        robot = setting.task.robot
        self.input_dim = setting.controller.input_dim
        self._chain = robot.chain
        self._control = control
        self._sessions = sessions
        self._goals_m_per_rad = [
            float(np.linalg.norm(robot.chain.jacobian(goal.configuration)[:3], ord=2))
            for goal in setting.task.goals
        ]
        self._report: Report | None = None
        self._heard_s = time.monotonic()
        self._trail = 0
        self._changed = asyncio.Event()
        self._number = 0
        self._cache: tuple[int, dict[bool, str]] = (-1, {})

    async def follow(self) -> None:
        """Look for new reports until cancelled; wakes those that wait in `after`."""
        told_silence = False
        while True:
            report = self._control.newest()
            silent = time.monotonic() - self._heard_s > SILENT_S
            if report is not None:
                self._report, self._heard_s = report, time.monotonic()
                told_silence = False
                self._wake()
            elif silent and not told_silence:
                told_silence = True
                self._wake()
            await asyncio.sleep(POLL_S)

    async def after(self, number: int) -> int:
        """Wait for a state that is newer than the one with this number.

        Returns:
            The newest one's number.
        """
        while self._number <= number or self._report is None:
            await self._changed.wait()
        return self._number

    def clear_trail(self) -> None:
        """Tell every page to empty its trail."""
        self._trail += 1

    @property
    def report(self) -> Report | None:
        """The newest report."""
        return self._report

    def text(self, page: Page, shown: GhostMemory) -> str:
        """The newest state as JSON, for a page."""
        report = self._report
        if report is None:
            raise RuntimeError("there is no report yet")
        ghosts = report.ghosts is not None and shown.differs(report.ghosts)
        drives = self._sessions.drives(page)
        number, texts = self._cache
        if number != self._number:
            texts = {}
            self._cache = (self._number, texts)
        if ghosts not in texts:
            texts[ghosts] = self._state(report, ghosts=ghosts).model_dump_json(exclude={"you"})[:-1]
        return f'{texts[ghosts]},"you":{json.dumps(drives)}}}'

    def _wake(self) -> None:
        self._number += 1
        self._changed.set()
        self._changed.clear()

    def _state(self, report: Report, *, ghosts: bool) -> State:
        driver, asking = self._sessions.driver, self._sessions.asking
        recording = report.recording
        silent = time.monotonic() - self._heard_s > SILENT_S
        return State(
            nonce=report.nonce,
            tick=report.tick,
            phase="disengaged" if silent else report.phase,
            why=self._silence() if silent else report.why,
            mode=report.mode,
            axes=report.axes,
            profile=report.profile,
            bodies=self._bodies(report),
            tool=_rounded(report.tool),
            ghosts=report.ghosts if ghosts else None,
            belief=tuple(round(share, 4) for share in report.belief) or None,
            alpha=round(report.alpha, 3),
            bound_m=self._bound_m(report),
            driver=None if driver is None else driver.id,
            driver_name=None if driver is None else driver.name,
            watchers=self._sessions.count - (driver is not None),
            asking=None if asking is None else asking.id,
            asking_name=None if asking is None else asking.name,
            recording=recording
            and RecordingState(
                on=recording.on,
                samples=recording.samples,
                episodes=recording.episodes,
                problem=recording.problem,
            ),
            trail=self._trail,
            late_share=round(report.late_share, 5),
            you=False,
        )

    def _silence(self) -> str:
        return _SILENT if self._control.alive else _DEAD

    def _bodies(self, report: Report) -> tuple[tuple[float, ...], ...]:
        links = self._chain.link_transforms(np.array(report.q))
        frames = np.concatenate([np.eye(4)[None], links])
        return tuple(tuple(round(value, 4) for value in pose) for pose in pose_of(frames).tolist())

    def _bound_m(self, report: Report) -> float | None:
        """The bound about the likeliest goal as the tool's distance, by the Jacobian at the goal."""
        if report.bound_rad is None or not report.belief:
            return None
        likeliest = int(np.argmax(report.belief))
        return round(report.bound_rad * self._goals_m_per_rad[likeliest], 4)


def _rounded(point: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = point
    return round(x, 4), round(y, 4), round(z, 4)
