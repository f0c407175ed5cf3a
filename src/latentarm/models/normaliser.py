"""Bringing contexts and actions to the same size before a network sees them."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.types import FloatArray

CONSTANT_SPREAD: Final = 1e-6
"""A feature that varies less than this (rad, or probability) is constant: dividing by its spread would
turn rounding into signal."""


@final
@dataclass(frozen=True)
class Normaliser:
    """An affine map of each feature: ``(x - centre) / scale``.

    Attributes:
        centre: (k,) or (1,).
        scale: (k,) or (1,), positive.
    """

    centre: FloatArray
    scale: FloatArray

    def apply(self, values: FloatArray) -> FloatArray:
        """Normalise values (..., k)."""
        return (values - self.centre) / self.scale

    def invert(self, normalised: FloatArray) -> FloatArray:
        """Undo `apply`, (..., k)."""
        return normalised * self.scale + self.centre

    def tensors(self) -> dict[str, FloatArray]:
        """Both arrays by name, as a normaliser of contexts is saved."""
        return {"context.centre": self.centre, "context.scale": self.scale}


def context_normaliser(context: FloatArray) -> Normaliser:
    """Zero mean and unit spread for every context feature on its own; a constant one is only centred.

    Args:
        context: (N, c).
    """
    spread = context.std(axis=0)
    return Normaliser(centre=context.mean(axis=0), scale=np.where(spread > CONSTANT_SPREAD, spread, 1.0))


def action_normaliser(action: FloatArray) -> Normaliser:
    """One scale for all joints and no offset.

    One scale keeps the loss proportional to ``‖a - a_h‖^2`` of equations 6-8 in rad/s: a scale per
    joint would weigh each joint by how little it moves. No offset keeps zero action at zero, which
    models with phi(0, c) = 0 stand on.

    Args:
        action: (N, m), rad/s, not all zero.
    """
    return Normaliser(centre=np.zeros(1), scale=np.sqrt(np.square(action).mean()).reshape(1))
