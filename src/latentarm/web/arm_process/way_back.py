"""The arm on its way to its start or a saved pose, while the driver's page lives and nobody pushes."""

import math
from dataclasses import replace
from typing import Final, Literal, final

import numpy as np

from latentarm.control.input_port import InputSource
from latentarm.core.types import FloatArray, Input
from latentarm.safety.straight_way import StraightWay
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

_LOOKS: Final = 2
"""At so many places in each tick the way is looked at before the arm sets out."""

Outcome = Literal["arrived", "stuck", "pushed", "blocked"]

_BACK: Final[dict[Outcome, NoticeCode]] = {
    "arrived": "at_start",
    "stuck": "return_stuck",
    "pushed": "return_pushed",
    "blocked": "return_blocked",
}
_TO_POSE: Final[dict[Outcome, NoticeCode]] = {
    "arrived": "at_pose",
    "stuck": "pose_stuck",
    "pushed": "pose_pushed",
    "blocked": "path_blocked",
}


@final
class WayBack(InputSource):
    """The person's inputs; on the way to a pose, the input that drives it, with the age of theirs.

    So the arm stops as for any motion where the page's inputs cease. Theirs must be neutral: any push, and
    anything asked of the gripper, ends the way. The arm sets out once the straight way was found clear, which
    takes a fraction of a second.

    Args:
        gate: where the inputs pass.
        inputs: of the page.
        start: (n,), where the way back leads, rad.
        straight: looks at the way before the arm sets out.

    Attributes:
        on: whether the arm is on its way.
        pose: what the pose is called that it leads to; None for the start.
    """

    def __init__(
        self, gate: NeutralFirst, inputs: PageInputs, start: FloatArray, straight: StraightWay
    ) -> None:
        self._straight = straight
        self._blocked: tuple[str, str] | None = None
        self._gate = gate
        self._inputs = inputs
        self._start = self._goal = start
        self.pose: str | None = None
        self._pushed = False
        self._began_s = self._closer_s = -math.inf
        self._closest = math.inf
        self.on = False

    def begin(self, time_s: float, q: FloatArray, goal: FloatArray, pose: str | None = None) -> None:
        """Look at the way, and set out if it is clear.

        Args:
            time_s: the loop's clock, s.
            q: (n,), where the arm stands, rad.
            goal: (n,), where the way leads, rad.
            pose: what that is called; None for the start.
        """
        self._straight.begin(q, goal)
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
        elif self._straight.clear:
            u[0] = 1.0
        return replace(given, u=u, gripper=None), age_s

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
        if not self._straight.clear:
            self._blocked = self._straight.look(_LOOKS)
            return None if self._blocked is None else "blocked"
        away = float(np.abs(self._goal - q).max())
        if away <= ARRIVED_RAD:
            return "arrived"
        if away < self._closest - _CLOSER_RAD:
            self._closest, self._closer_s = away, time_s
        slow = time_s - self._closer_s > STUCK_S or time_s - self._began_s > LONGEST_S
        return "stuck" if slow else None

    def ending(self, outcome: Outcome) -> Notice:
        """What people are told at the end of the way.

        Args:
            outcome: how it ended.
        """
        parameters: dict[str, str | int] = {}
        if outcome == "stuck":
            parameters["seconds"] = round(STUCK_S)
        if outcome == "blocked" and self._blocked is not None:
            parameters["first"], parameters["second"] = self._blocked
        if self.pose is None:
            return Notice(code=_BACK[outcome], parameters=parameters)
        return Notice(code=_TO_POSE[outcome], parameters={**parameters, "pose": self.pose})
