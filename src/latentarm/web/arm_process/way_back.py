"""The arm on its way to its start or a saved pose, while the driver's page lives and nobody pushes."""

import math
from typing import Final, Literal, final

import numpy as np

from latentarm.control.input_port import InputSource
from latentarm.types import FloatArray, Input
from latentarm.web.arm_process.neutral_first import NeutralFirst
from latentarm.web.arm_process.page_inputs import PageInputs
from latentarm.web.protocol.notice import Notice, NoticeCode

ARRIVED_RAD: Final = 0.01
"""Every joint is at the start within this."""

AT_START_RAD: Final = 0.02
"""Nothing is gained by a way back from nearer than this."""

STUCK_S: Final = 3.0
"""The way back ends where nothing has come closer for so long, s."""

LONGEST_S: Final = 60.0
"""No way back takes longer, s."""

_CLOSER_RAD: Final = 0.005

Outcome = Literal["arrived", "stuck", "pushed"]

_BACK: Final[dict[Outcome, NoticeCode]] = {
    "arrived": "at_start",
    "stuck": "return_stuck",
    "pushed": "return_pushed",
}
_TO_POSE: Final[dict[Outcome, NoticeCode]] = {
    "arrived": "at_pose",
    "stuck": "pose_stuck",
    "pushed": "pose_pushed",
}


def ending(outcome: Outcome, pose: str | None) -> Notice:
    """What people are told at the end of a way.

    Args:
        outcome: how it ended.
        pose: what the pose is called; None for the start.
    """
    parameters: dict[str, str | int] = {"seconds": round(STUCK_S)} if outcome == "stuck" else {}
    if pose is None:
        return Notice(code=_BACK[outcome], parameters=parameters)
    return Notice(code=_TO_POSE[outcome], parameters={**parameters, "pose": pose})


@final
class WayBack(InputSource):
    """The person's inputs; on the way to a pose, the input that drives it, with the age of theirs.

    So the arm stops as for any motion where the page's inputs cease. Theirs must be neutral: any push, and
    anything asked of the gripper, ends the way.

    Args:
        gate: where the inputs pass.
        inputs: of the page.
        start: (n,), where the way back leads, rad.

    Attributes:
        on: whether the arm is on its way.
        pose: what the pose is called that it leads to; None for the start.
    """

    def __init__(self, gate: NeutralFirst, inputs: PageInputs, start: FloatArray) -> None:
        self._gate = gate
        self._inputs = inputs
        self._start = self._goal = start
        self.pose: str | None = None
        self._pushed = False
        self._began_s = self._closer_s = -math.inf
        self._closest = math.inf
        self.on = False

    def begin(self, time_s: float, goal: FloatArray, pose: str | None = None) -> None:
        """Set out, from the next tick on.

        Args:
            time_s: the loop's clock, s.
            goal: (n,), where the way leads, rad.
            pose: what that is called; None for the start.
        """
        self._goal, self.pose = goal, pose
        self.on, self._pushed = True, False
        self._began_s = self._closer_s = time_s
        self._closest = math.inf

    def end(self) -> None:
        """The person's inputs count again, once they have let go."""
        if self.on:
            self.on = False
            self._gate.demand()

    def latest(self, now_s: float) -> tuple[Input, float]:
        """See the base class."""
        given, age_s = self._gate.latest(now_s)
        if not self.on:
            return given, age_s
        u = np.zeros_like(given.u)
        if self._inputs.deflected or given.gripper is not None:
            self._pushed = True
        else:
            u[0] = 1.0
        return Input(u), age_s

    def away(self, q: FloatArray) -> float:
        """How far the farthest joint is from the start, rad.

        Args:
            q: (n,), joint positions, rad.
        """
        return float(np.abs(self._start - q).max())

    def outcome(self, q: FloatArray, time_s: float) -> Outcome | None:
        """How the way has ended, or None where it goes on.

        Args:
            q: (n,), joint positions, rad.
            time_s: the loop's clock, s.
        """
        if self._pushed:
            return "pushed"
        away = float(np.abs(self._goal - q).max())
        if away <= ARRIVED_RAD:
            return "arrived"
        if away < self._closest - _CLOSER_RAD:
            self._closest, self._closer_s = away, time_s
        slow = time_s - self._closer_s > STUCK_S or time_s - self._began_s > LONGEST_S
        return "stuck" if slow else None
