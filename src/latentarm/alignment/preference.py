"""A simulated person's meaning of the axes of the stick."""

import math
from dataclasses import dataclass
from typing import Final, Protocol, final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Chain

AXES: Final = "xyz"


class Preference(Protocol):
    """The inputs with which a simulated person would ask for motions."""

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, d) by which they would ask for N motions."""
        ...


@final
@dataclass(frozen=True, eq=False)
class ToolAxes:
    """A simulated person for whom each axis of the stick is one of the base frame: x, then y, then z.

    They consider where the tool goes and ignore how it turns.

    Raises UserError where there are more axes than directions, or the speed is not positive.
    """

    chain: Chain  # the arm, of which the first tool counts
    axes: int  # d, of the stick, 1 to 3
    speed_m_s: float  # of the tool along an axis, for which they would push all the way, m/s

    def __post_init__(self) -> None:
        if not 1 <= self.axes <= len(AXES):
            raise UserError(
                f"The simulated person thinks in {', '.join(AXES)} and cannot answer for {self.axes} axes."
            )
        check_speed(self.speed_m_s, "m/s")

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, d) by which they would ask for N motions."""
        moved = self.chain.forward(motions.end).position - self.chain.forward(motions.start).position
        wanted = moved[:, : self.axes] / (self.speed_m_s * motions.duration_s)
        return np.clip(wanted, -1.0, 1.0)


def check_speed(speed: float, unit: str) -> None:
    """Raise a UserError unless the speed of a full push is positive."""
    if not (math.isfinite(speed) and speed > 0):
        raise UserError(f"The simulated person's speed must be positive, not {speed:g} {unit}.")
