"""How the person's action and the robot's are put together (equations 2 and 10)."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.errors import UserError
from latentarm.types import FloatArray


def blend(action_human: FloatArray, action_assist: FloatArray, alpha: float) -> FloatArray:
    """``a = (1 - alpha) a_h + alpha a_r`` (equation 2; with equation 3 it is equation 10).

    Args:
        action_human: (..., m), ``a_h``, rad/s.
        action_assist: (..., m), ``a_r``, rad/s.
        alpha: 0 leaves all to the person, 1 all to the robot.

    Returns:
        (..., m), rad/s.
    """
    return (1.0 - alpha) * action_human + alpha * action_assist


class Arbitration(ABC):
    """Decides how much the robot helps."""

    @abstractmethod
    def alpha(self, u: FloatArray, belief: FloatArray) -> float:
        """The arbitration of equation 2 for one step.

        Every arbitration goes to zero with the input: an arm whose person lets go stands still.

        Args:
            u: (d,), the person's input.
            belief: (G,), probability over goals.

        Returns:
            alpha in [0, 1].
        """


@final
@dataclass(frozen=True)
class FixedAlpha(Arbitration):
    """The paper's constant alpha, faded out as the person lets go of the input.

    Attributes:
        value: alpha in [0, 1] at inputs of ``full_at`` and more.
        full_at: ‖u‖ from which help is full; below, alpha shrinks in proportion, to zero at zero.
    """

    value: float = 0.15
    full_at: float = 0.3

    def __post_init__(self) -> None:
        if not 0 <= self.value <= 1:
            raise UserError(f"The arbitration alpha must be in [0, 1], not {self.value}.")
        if not 0 < self.full_at <= 1:
            raise UserError(f"The input at which help is full must be in (0, 1], not {self.full_at}.")

    def alpha(self, u: FloatArray, belief: FloatArray) -> float:
        """Constant, times ‖u‖ / full_at where that is below one; zero for an input that is not finite."""
        size = float(np.sqrt(u @ u))
        return self.value * min(size / self.full_at, 1.0) if np.isfinite(size) else 0.0
