"""What each Franka arm can do, and how much of it commands may use."""

import re
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.panda import LIMITS as PANDA_LIMITS
from latentarm.robots.robot import Robot

SHARE: Final = 0.99
"""How much of a limit is used; a share of 1 exceeds some by rounding."""

_AHEAD_S: Final = 0.1
"""Speeds are kept within the limits of where a joint will be after this time too, s."""


@final
@dataclass(frozen=True, eq=False)
class FrankaLimits:
    """What one kind of arm can do.

    Attributes:
        kind: what its manufacturer calls it.
        lower: (7,), lowest joint position that the arm allows, rad.
        upper: (7,), highest, rad.
        velocity: (7,), rad/s.
        acceleration: (7,), rad/s².
        jerk: (7,), rad/s³.
        deceleration: (7,), how fast a joint slows down towards its ends, rad/s².
        offset: (7,), how much slower it is there than it could be, rad/s.
    """

    kind: str
    lower: FloatArray
    upper: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    jerk: FloatArray
    deceleration: FloatArray
    offset: FloatArray

    def speeds(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The limits of a velocity at a position, as libfranka computes them from the model of an FR3.

        Args:
            q: (7,), rad.

        Returns:
            Lowest and highest velocity, each (7,), rad/s; zero lies between them.
        """
        down = np.sqrt(2.0 * self.deceleration * np.maximum(q - self.lower, 0.0)) - self.offset
        up = np.sqrt(2.0 * self.deceleration * np.maximum(self.upper - q, 0.0)) - self.offset
        return -np.clip(down, 0.0, self.velocity), np.clip(up, 0.0, self.velocity)

    def slowed(self, velocity: FloatArray, q: FloatArray) -> FloatArray:
        """A velocity in the same direction that keeps to `SHARE` of the limits, now and a moment ahead.

        Args:
            velocity: (7,), rad/s.
            q: (7,), rad.

        Returns:
            (7,), rad/s.
        """
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

    def excess(self, robot: Robot) -> str:
        """What of a robot's limits the arm cannot do, in words; "" where it can do everything."""
        theirs = robot.limits
        for joint in range(robot.dof):
            for what, asked, can, unit in (
                ("lowest position", -theirs.lower[joint], -self.lower[joint], "rad"),
                ("highest position", theirs.upper[joint], self.upper[joint], "rad"),
                ("speed", theirs.velocity[joint], self.velocity[joint], "rad/s"),
                ("acceleration", theirs.acceleration[joint], self.acceleration[joint], "rad/s²"),
                ("jerk", theirs.jerk[joint], self.jerk[joint], "rad/s³"),
            ):
                if asked > can + 1e-9:
                    sign = -1.0 if what == "lowest position" else 1.0
                    name = robot.joint_names[joint]
                    return f"the {what} of {name} is {sign * asked:g} {unit}, the arm's {sign * can:g}"
        return ""


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
    """The limits of the arm that describes itself so.

    Args:
        urdf: the model that the arm sends; a Panda sends none.

    Returns:
        Its limits, or None where it is another arm.
    """
    if not urdf:
        return PANDA
    named = re.search(r"<robot[^>]*\bname\s*=\s*[\"']([^\"']+)", urdf)
    name = "" if named is None else named[1].lower()
    if "fr3" in name or "research3" in name.replace(" ", "").replace("_", ""):
        return FR3
    if "panda" in name or "fer" in name:
        return PANDA
    return None
