"""A person's meaning of an input, in the space of the tools: u = Q(c) dx. NumPy alone."""

from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.core.types import FloatArray


@final
@dataclass(frozen=True, eq=False)
class Meaning:
    """``Q(c) = R(theta(x)) Q_0``: a fixed map from twists to inputs, and a stick that turns with the place.

    theta(x) = sum_i turn_i exp(-‖x - x_i‖^2 / 2 l^2); only a stick of two axes turns.
    """

    matrix: FloatArray  # (d, 6 k), Q_0, inputs per twist of `motion_twists`, s/m
    place: FloatArray  # (N, 12 k), places x_i of the answers, m
    turn_rad: FloatArray  # (N,), turn_i
    length_m: float  # l

    def __call__(self, place: FloatArray) -> FloatArray:
        """Q (..., d, 6 k) at places (..., 12 k)."""
        if not self.turn_rad.any():
            return np.broadcast_to(self.matrix, (*place.shape[:-1], *self.matrix.shape))
        apart = np.square(place[..., None, :] - self.place).sum(axis=-1)
        angle = np.exp(-0.5 * apart / self.length_m**2) @ self.turn_rad
        return rotations(angle) @ self.matrix


def rotations(angle: FloatArray) -> FloatArray:
    """Turns of a stick of two axes by angles (...), rad: (..., 2, 2)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([cos, -sin], axis=-1), np.stack([sin, cos], axis=-1)], axis=-2)
