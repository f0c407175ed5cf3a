"""What Algorithm 1's loop makes of an input before the arm moves, as far as a simulated person knows it."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.types import BoolArray, FloatArray


@final
@dataclass(frozen=True, eq=False)
class LoopLimits:
    """The loop's dead zone and how fast it lets joints move; by default neither limits anything."""

    dead_zone: float = 0.0  # length of an input up to which the loop takes it for rest, in [0, 1)
    # (n,) or one for all joints, rad/s (m/s where a joint slides). What would be faster is slowed down in its
    # direction
    speed: FloatArray | float = np.inf

    def is_push(self, u: FloatArray) -> BoolArray:
        """Whether inputs (..., d) are more than rest, (...)."""
        return np.linalg.norm(u, axis=-1) > self.dead_zone

    def slowed(self, action: FloatArray) -> FloatArray:
        """Actions (..., n) as the loop lets the arm move."""
        excess = np.abs(action) / self.speed
        return action / np.maximum(excess.max(axis=-1, keepdims=True), 1.0)


UNLIMITED: Final = LoopLimits()
"""No loop between the person and the arm."""
