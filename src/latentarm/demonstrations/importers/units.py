"""Units of recorded positions, and their conversion to rad."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal, final, get_args

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import BoolArray, FloatArray
from latentarm.robots.limits import JointLimits

Unit = Literal["rad", "deg", "normalized"]
UNITS: Final[tuple[Unit, ...]] = get_args(Unit)
TARGET_POSITION: Final = "action.target_position"  # commanded joint positions, rad
FULL_TURN: Final = "wrist_roll"
"""The joint of SO-100 and SO-101 that LeRobot calibrates to a full turn, whatever its stops."""


@final
@dataclass(frozen=True)
class Conversion:
    """Converts recorded positions v to ``scale * v + offset``, each (n,), in rad (m where prismatic)."""

    scale: FloatArray
    offset: FloatArray

    def positions(self, recorded: FloatArray) -> FloatArray:
        """Recorded positions (..., n) in rad."""
        return recorded * self.scale + self.offset

    def rates(self, recorded: FloatArray) -> FloatArray:
        """Recorded velocities (..., n) in rad/s."""
        return recorded * self.scale


def parse_units(words: Sequence[str], joints: Sequence[str]) -> tuple[Unit | None, Mapping[str, Unit]]:
    """The unit for all joints and those of single joints, from ``deg`` or ``JOINT=deg``."""
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
    """The conversion from recorded positions to those of the robot.

    ``normalized`` is assumed to run from -100 to 100 over a joint's limits; LeRobot's calibration runs from
    one mechanical stop to the other, wherever these are. Prismatic joints are in m under ``rad`` and ``deg``
    alike. ``full_turn`` says whether `FULL_TURN` runs over a full turn.
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
    return Conversion(scale, offset)
