"""Slow motions to the start or a saved pose, while the driver's page is connected and nobody pushes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, final

import numpy as np

from latentarm.control.input_port import InputSource
from latentarm.core.types import FloatArray, Input
from latentarm.robots.kinematics.obstacles import Box
from latentarm.safety.straight_way import StraightWay
from latentarm.web.arm_process.neutral_interlock import NeutralInterlock
from latentarm.web.arm_process.page_inputs import PageInputs
from latentarm.web.protocol.notice import Notice, NoticeCode

ARRIVED_RAD: Final = 0.01  # every joint is at the goal within this
AT_START_RAD: Final = 0.02  # from nearer than this a way back is pointless
STUCK_S: Final = 3.0  # the way ends after so long without progress, s
LONGEST_S: Final = 60.0

_CLOSER_RAD: Final = 0.005
_LOOKS: Final = 2  # places on the way that are checked in each tick before the arm sets out

Outcome = Literal["arrived", "stuck", "pushed", "blocked"]

_ENDINGS: Final[dict[Outcome, tuple[NoticeCode, NoticeCode]]] = {
    "arrived": ("at_start", "at_pose"),
    "stuck": ("return_stuck", "pose_stuck"),
    "pushed": ("return_pushed", "pose_pushed"),
    "blocked": ("return_blocked", "path_blocked"),
}
"""Notices at the end of a way back to the start, and of one to a saved pose."""


@final
@dataclass(eq=False)
class PoseMotion(InputSource):
    """The person's inputs; on the way to a pose, the input that drives it, with the age of theirs.

    So the arm stops as in any motion when the page's inputs cease. Theirs must be neutral: any push, and any
    request to the gripper, ends the way. The arm sets out once the straight way was found clear, which takes
    a fraction of a second.
    """

    _gate: NeutralInterlock
    _inputs: PageInputs
    _start: FloatArray
    _straight: StraightWay

    def __post_init__(self) -> None:
        self._blocked: tuple[str, str] | None = None
        self._goal = self._start
        self.pose: str | None = None  # the name of the pose that it leads to; None for the start
        self._pushed = False
        self._began_s = self._closer_s = -math.inf
        self._closest = math.inf
        self.on = False  # whether the arm is on its way

    def begin(
        self, time_s: float, q: FloatArray, goal: FloatArray, held: Sequence[Box], pose: str | None = None
    ) -> None:
        """Check the way from ``q`` to ``goal``, (n,), rad, and set out if it is clear; ``pose`` names it."""
        self._straight.begin(q, goal, held)
        self._goal, self.pose = goal, pose
        self.on, self._pushed = True, False
        self._began_s = self._closer_s = time_s
        self._closest = math.inf

    def end(self) -> None:
        """Let the person's inputs count again, once they have let go."""
        if self.on:
            self.on = False
            self._gate.demand()

    def latest(self, now_s: float) -> tuple[Input, float]:
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
        """How far the farthest joint of ``q``, (n,), is from the start, rad."""
        return float(np.abs(self._start - q).max())

    def outcome(self, q: FloatArray, time_s: float) -> Outcome | None:
        """How the way has ended at ``q``, (n,), rad, and ``time_s``; None while it goes on."""
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
        """The notice at the end of the way."""
        parameters: dict[str, str | int] = {}
        if outcome == "stuck":
            parameters["seconds"] = round(STUCK_S)
        if outcome == "blocked" and self._blocked is not None:
            parameters["first"], parameters["second"] = self._blocked
        back, to_pose = _ENDINGS[outcome]
        if self.pose is None:
            return Notice(code=back, parameters=parameters)
        return Notice(code=to_pose, parameters={**parameters, "pose": self.pose})
