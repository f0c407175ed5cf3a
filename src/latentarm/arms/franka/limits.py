"""Limits of each Franka arm, and the share of them that commands may use."""

import re
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.arms.real import FoundLimits
from latentarm.core.types import FloatArray
from latentarm.robots.panda import LIMITS as PANDA_LIMITS

SHARE: Final = 0.99  # used share of a limit; a share of 1 exceeds some by rounding
_AHEAD_S: Final = 0.1  # speeds also keep the limits of the position after this time


@final
@dataclass(frozen=True, eq=False)
class FrankaLimits:
    """Limits of one kind of arm."""

    kind: str  # the manufacturer's name
    lower: FloatArray  # (7,), rad
    upper: FloatArray  # (7,), rad
    velocity: FloatArray  # (7,), rad/s
    acceleration: FloatArray  # (7,), rad/s²
    jerk: FloatArray  # (7,), rad/s³
    deceleration: FloatArray  # (7,), towards the ends of a joint, rad/s²
    offset: FloatArray  # (7,), reduction of the speed there, rad/s

    def speeds(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Velocity limits, each (7,), rad/s, at a position (7,), rad, by libfranka's formula for an FR3."""
        down = np.sqrt(2.0 * self.deceleration * np.maximum(q - self.lower, 0.0)) - self.offset
        up = np.sqrt(2.0 * self.deceleration * np.maximum(self.upper - q, 0.0)) - self.offset
        return -np.clip(down, 0.0, self.velocity), np.clip(up, 0.0, self.velocity)

    def slowed(self, velocity: FloatArray, q: FloatArray) -> FloatArray:
        """A velocity (7,), rad/s, in the same direction, within `SHARE` of the limits now and soon."""
        ahead = np.clip(velocity, -self.velocity, self.velocity) * _AHEAD_S
        factor = 1.0
        for where in (q, q + ahead):
            least, most = self.speeds(where)
            allowed = SHARE * np.where(velocity > 0.0, most, -least)
            asked = np.abs(velocity)
            over = asked > allowed
            if over.any():
                factor = min(factor, float((allowed[over] / asked[over]).min()))
        return factor * velocity

    def exceeds(self, velocity: FloatArray, q: FloatArray) -> bool:
        """Whether a velocity (7,), rad/s, is over the limits at a position (7,), rad."""
        least, most = self.speeds(q)
        return bool(((velocity > most) | (velocity < least)).any())

    @property
    def found(self) -> FoundLimits:
        """The limits that those of a robot are compared with."""
        return FoundLimits(self.lower, self.upper, self.velocity, self.acceleration, self.jerk, rounding=1e-9)


FR3: Final = FrankaLimits(
    "Franka Research 3",
    lower=np.array([-2.7501, -1.7918, -2.9065, -3.0481, -2.8101, 0.54092, -3.0196]),
    upper=np.array([2.7501, 1.7918, 2.9065, -0.1458, 2.8101, 4.5205, 3.0196]),
    velocity=np.array([2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26]),
    acceleration=np.full(7, 10.0),
    jerk=np.full(7, 5000.0),
    deceleration=np.array([6.0, 2.585, 3.5, 4.0, 17.0, 5.5, 17.0]),
    offset=np.array([0.30, 0.20, 0.20, 0.30, 0.35, 0.35, 0.35]),
)
"""https://frankarobotics.github.io/docs/robot_specifications.html; ends, and what holds near them, as in the
model that the arm sends."""

PANDA: Final = FrankaLimits(
    "Franka Emika Panda",
    PANDA_LIMITS.lower,
    PANDA_LIMITS.upper,
    PANDA_LIMITS.velocity,
    PANDA_LIMITS.acceleration,
    PANDA_LIMITS.jerk,
    deceleration=PANDA_LIMITS.acceleration / 2.0,
    offset=np.zeros(7),
)
"""https://frankarobotics.github.io/docs/control_parameters.html. Its speed limit is the same everywhere; near
the ends half of its acceleration is kept for stopping."""


def limits_of(urdf: str) -> FrankaLimits | None:
    """The limits of the arm that sends this URDF (a Panda sends none), or None for another arm."""
    if not urdf:
        return PANDA
    named = re.search(r"<robot[^>]*\bname\s*=\s*[\"']([^\"']+)", urdf)
    name = "" if named is None else named[1].lower()
    if "fr3" in name or "research3" in name.replace(" ", "").replace("_", ""):
        return FR3
    if "panda" in name or "fer" in name:
        return PANDA
    return None
