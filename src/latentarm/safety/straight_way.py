"""Whether the straight way of the joints to a pose is clear, before the arm sets out."""

import math
from collections.abc import Sequence
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.held import holding
from latentarm.robots.kinematics.obstacles import Box
from latentarm.robots.robot import Robot
from latentarm.safety.body import Body, Placement
from latentarm.safety.config import SafetyConfig
from latentarm.safety.proximity import Contacts, Proximity

LARGEST_RAD: Final = 0.05  # the farthest joint moves no farther between two looks, rad
_SMALLEST_RAD: Final = 0.003
_NEARER_M: Final = 1e-3  # things that are too near already may come nearer by this much at most, m


@final
class StraightWay:
    """Follows the way in thought, past the obstacles and the arm's own links that the safety filters know.

    Between two looks every distance has a lower bound (`Proximity.heights`). Where it does not suffice, the
    next look is nearer; no two looks are closer than 3 mrad, so a corner may be cut by about as many mm.
    """

    def __init__(self, robot: Robot, safety: SafetyConfig) -> None:
        self._robot, self._safety = robot, safety
        self.begin(robot.home, robot.home)
        self.clear = True

    def begin(self, start: FloatArray, goal: FloatArray, held: Sequence[Box] = ()) -> None:
        """Look at another way, from where the arm is to where it goes, (n,), rad, with what it holds."""
        self._body, keep_m = Body(holding(self._robot, held)), self._safety.clearance
        self._proximity = Proximity(self._body, self._safety.obstacles, math.inf, keep_m, 1.0, keep_m)
        self._allowed = np.full(len(self._proximity.names), keep_m)
        self._start, self._way = start, goal - start
        farthest = float(np.abs(self._way).max())
        self._step = min(1.0, LARGEST_RAD / max(farthest, LARGEST_RAD))
        self._share = 0.0
        self.clear = False

    def look(self, times: int) -> tuple[str, str] | None:
        """Look at up to ``times`` further places: the two things that would come too close, or None so far.

        Once `clear` is set, there are none on the whole way.
        """
        for _ in range(times):
            if self.clear:
                return None
            blocked = self._look()
            if blocked is not None:
                return blocked
        return None

    def _look(self) -> tuple[str, str] | None:
        proximity = self._proximity
        placement = Placement(self._body, self._start + self._share * self._way)
        contacts = proximity.measured(placement, self._step * np.abs(self._way))
        height = contacts.height.min(axis=1)
        if self._share == 0.0:
            np.minimum.at(self._allowed, contacts.pair, height - _NEARER_M)
        room = height - self._allowed[contacts.pair]
        if len(room) and room.min() < 0.0:
            first, _, second = proximity.names[contacts.pair[int(room.argmin())]].partition(" and ")
            return _short(first), _short(second)
        if self._share >= 1.0:
            self.clear = True
            return None
        self._share = min(1.0, self._share + self._sure_step(contacts))
        return None

    def _sure_step(self, contacts: Contacts) -> float:
        """The share of the way that can be gone from here without anything coming too near."""
        farthest = float(np.abs(self._way).max())
        step = self._step
        while step * farthest > _SMALLEST_RAD:
            bound = self._proximity.heights(contacts, step * self._way).min(axis=1)
            if (bound >= self._allowed[contacts.pair]).all():
                break
            step *= 0.5
        return step


def _short(name: str) -> str:
    """A capsule's name, which names each of several bodies once."""
    return " + ".join(dict.fromkeys(name.split(" + ")))
