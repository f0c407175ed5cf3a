"""What a simulated person sees at one moment."""

from dataclasses import dataclass
from typing import final

from latentarm.types import Context, FloatArray, Pose


@final
@dataclass(frozen=True, eq=False)
class Moment:
    """What a simulated person sees at one moment.

    Attributes:
        context: what the arm is at and believes.
        mode: the controller's mode.
        target: the pose that they want the tool at.
        u: (d,), the input that has just been given.
    """

    context: Context
    mode: int
    target: Pose
    u: FloatArray
