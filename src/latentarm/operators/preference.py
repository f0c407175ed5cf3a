"""What a simulated person means by the axes of the stick."""

import math
from dataclasses import dataclass
from typing import Final, Protocol, final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.errors import UserError
from latentarm.kinematics.chain import Chain
from latentarm.types import FloatArray

AXES: Final = "xyz"


class Preference(Protocol):
    """What a simulated person would do to have motions made."""

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, d) by which they would ask for N motions."""
        ...


@final
@dataclass(frozen=True, eq=False)
class ToolAxes:
    """A simulated person for whom each axis of the stick is one of the base frame: x, then y, then z.

    They answer by where the tool goes and pay no heed to how it turns.

    Attributes:
        chain: the arm; its first tool is looked at.
        axes: d, of the stick, 1 to 3.
        speed_m_s: of the tool along an axis, for which they would push all the way, m/s.

    Raises:
        UserError: there are more axes than directions, or the speed is not positive.
    """

    chain: Chain
    axes: int
    speed_m_s: float

    def __post_init__(self) -> None:
        if not 1 <= self.axes <= len(AXES):
            raise UserError(
                f"The simulated person thinks in {', '.join(AXES)} and cannot answer for {self.axes} axes."
            )
        if not (math.isfinite(self.speed_m_s) and self.speed_m_s > 0):
            raise UserError(f"The simulated person's speed must be positive, not {self.speed_m_s:g} m/s.")

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, d) by which they would ask for N motions."""
        moved = self.chain.forward(motions.end).position - self.chain.forward(motions.start).position
        wanted = moved[:, : self.axes] / (self.speed_m_s * motions.duration_s)
        return np.clip(wanted, -1.0, 1.0)
