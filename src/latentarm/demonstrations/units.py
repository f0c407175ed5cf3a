"""The unit of each joint's recorded positions, and the way from there to rad."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal, final, get_args

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray
from latentarm.robots.limits import JointLimits

Unit = Literal["rad", "deg", "normalized"]

UNITS: Final[tuple[Unit, ...]] = get_args(Unit)

TARGET_POSITION: Final = "action.target_position"
"""Joint positions that were commanded, rad."""

FULL_TURN: Final = "wrist_roll"
"""The joint of SO-100 and SO-101 that LeRobot calibrates to a full turn, whatever its stops."""


@final
@dataclass(frozen=True)
class Conversion:
    """Recorded positions v to positions of the robot: ``scale * v + offset``, in rad (m where prismatic).

    Attributes:
        units: n units, one for each joint.
        scale: (n,).
        offset: (n,).
    """

    units: tuple[Unit, ...]
    scale: FloatArray
    offset: FloatArray

    def positions(self, recorded: FloatArray) -> FloatArray:
        """Recorded positions (..., n) in rad."""
        return recorded * self.scale + self.offset

    def rates(self, recorded: FloatArray) -> FloatArray:
        """Recorded velocities (..., n) in rad/s."""
        return recorded * self.scale


def parse_units(words: Sequence[str], joints: Sequence[str]) -> tuple[Unit | None, Mapping[str, Unit]]:
    """What ``--units`` says: a unit for all joints, and those of single joints.

    Args:
        words: ``deg``, or ``JOINT=deg``, any number of them.
        joints: the robot's joint names.
    """
    general: Unit | None = None
    single: dict[str, Unit] = {}
    for word in words:
        joint, _, unit = word.rpartition("=")
        if unit not in UNITS or (joint and joint not in joints):
            raise UserError(
                f"--units {word!r} is not understood: give {', '.join(UNITS)}, or JOINT=UNIT for one of"
                f" {', '.join(joints)}."
            )
        if joint:
            single[joint] = unit
        else:
            general = unit
    return general, single


def conversion(
    units: Sequence[Unit], joints: Sequence[str], limits: JointLimits, slide: BoolArray, *, full_turn: bool
) -> Conversion:
    """How recorded positions become those of the robot.

    ``normalized`` runs from -100 to 100 over a joint's limits, which is an assumption: LeRobot's calibration
    runs from one mechanical stop to the other, wherever these are. Prismatic joints are in m under ``rad``
    and ``deg`` alike.

    Args:
        units: n units.
        joints: n names.
        limits: of the joints.
        slide: (n,), which joints are prismatic.
        full_turn: whether `FULL_TURN` runs over a full turn.
    """
    scale, offset = np.ones(len(units)), np.zeros(len(units))
    for index, (unit, joint) in enumerate(zip(units, joints, strict=True)):
        if unit == "deg" and not slide[index]:
            scale[index] = np.pi / 180.0
        elif unit == "normalized" and full_turn and joint == FULL_TURN:
            scale[index] = np.pi / 100.0
        elif unit == "normalized":
            scale[index] = (limits.upper[index] - limits.lower[index]) / 200.0
            offset[index] = 0.5 * (limits.upper[index] + limits.lower[index])
    return Conversion(tuple(units), scale, offset)
