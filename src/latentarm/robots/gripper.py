"""A gripper with two parallel fingers, as its manufacturer states it."""

from dataclasses import dataclass
from typing import final


@final
@dataclass(frozen=True)
class Gripper:
    """Two parallel fingers that move by the same amount.

    Attributes:
        joints: the sliding joints of its fingers in the robot's model; at zero they meet, and each moves by
            half the opening.
        width_m: the largest opening, m.
        speed_m_s: the fastest change of the opening, m/s.
        force_n: the largest force with which the fingers press together, N.
    """

    joints: tuple[str, ...]
    width_m: float
    speed_m_s: float
    force_n: float
