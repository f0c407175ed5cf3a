"""What a simulated person sees at one moment."""

from dataclasses import dataclass, field
from typing import Final, final

import numpy as np

from latentarm.core.types import BoolArray, Context, FloatArray, Pose

USUAL_WITHIN_M: Final = 0.02
"""How near a simulated person has to come for which their figures are stated, m."""


NOTHING_HELD: Final[BoolArray] = np.zeros(0, dtype=np.bool_)


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
        speed: share of their usual speed that is fit there, in (0, 1].
        held: (K,), which of the context's things the tool holds.
    """

    context: Context
    mode: int
    target: Pose
    u: FloatArray
    within_m: float = USUAL_WITHIN_M
    speed: float = 1.0
    held: BoolArray = field(default_factory=lambda: NOTHING_HELD)
