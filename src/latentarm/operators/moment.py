"""What a simulated person sees at one moment."""

from dataclasses import dataclass
from typing import Final, final

from latentarm.types import Context, FloatArray, Pose

USUAL_WITHIN_M: Final = 0.02
"""How near a simulated person has to come for which their figures are stated, m."""


@final
@dataclass(frozen=True, eq=False)
class Moment:
    """What a simulated person sees at one moment.

    Attributes:
        context: what the arm is at and believes.
        mode: the controller's mode.
        target: the pose that they want the tool at.
        u: (d,), the input that has just been given.
        within_m: how near they have to come to it, m.
    """

    context: Context
    mode: int
    target: Pose
    u: FloatArray
    within_m: float = USUAL_WITHIN_M
