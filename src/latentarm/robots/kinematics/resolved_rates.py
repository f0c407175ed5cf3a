"""Resolved rates: joint velocities for a twist, damped near singular configurations."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray


@final
@dataclass(frozen=True)
class Damping:
    """Damping of resolved rates near singular configurations.

    A singular value σ of the Jacobian is inverted as ``σ / (σ² + λ²)`` with ``λ² = (1 - (σ / threshold)²)
    factor²`` below ``threshold`` and 0 above: Nakamura and Hanafusa's variable damping, for each singular
    direction separately as Chiaverini proposed, so that possible motions stay exact. Metres and radians count
    alike.
    """

    threshold: float = 0.1  # singular value below which damping begins, m or rad per rad
    factor: float = 0.1  # damping at a singular configuration, same unit

    def __post_init__(self) -> None:
        for name, value in (("threshold", self.threshold), ("factor", self.factor)):
            if not 0 < value < np.inf:
                raise UserError(f"The damping's {name} must be positive and finite, not {value}.")

    def inverse(self, singular: FloatArray) -> FloatArray:
        """Damped reciprocals of singular values (..., k)."""
        share = np.minimum(singular / self.threshold, 1.0)
        squared = singular * singular + (1.0 - share * share) * self.factor**2
        return singular / squared


def joint_velocities(twists: FloatArray, jacobian: FloatArray, damping: Damping) -> FloatArray:
    """The smallest joint velocities (..., K, n), rad/s, for base-frame twists (..., K, 6), m/s and rad/s."""
    left, singular, right = np.linalg.svd(jacobian, full_matrices=False)
    inverse = damping.inverse(singular)[..., None, :]
    return twists @ (left * inverse) @ right
