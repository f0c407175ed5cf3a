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
    """What a simulated person sees at one moment."""

    context: Context  # what the arm is at and believes
    mode: int  # the controller's mode
    target: Pose  # the pose that they want the tool at
    u: FloatArray  # (d,), the input that has just been given
    within_m: float = USUAL_WITHIN_M  # how near they have to come to it, m
    speed: float = 1.0  # share of their usual speed that is fit there, in (0, 1]
    # (K,), which of the context's things the tool holds
    held: BoolArray = field(default_factory=lambda: NOTHING_HELD)
