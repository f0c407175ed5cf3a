"""What is a person's own: how fast they go, and how the stick is turned, or upside down, for them."""

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.preference import Preference
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm_research.people.contract import LoopLimits


@final
@dataclass(frozen=True)
class OwnSpeed:
    """How fast a simulated person likes to go."""

    share: float = 1.0  # of the speed of somebody who pushes as far as it takes, in (0, 1]

    def pushed(self, u: FloatArray, limits: LoopLimits) -> FloatArray:
        """Where they push the stick (d,), where somebody who goes full speed would push it to u (d,).

        Pushes shrink in proportion beyond the dead zone, so that what is a push remains one.
        """
        if self.share == 1.0 or not limits.is_push(u):
            return u
        length = float(np.linalg.norm(u))
        return u * ((limits.dead_zone + self.share * (length - limits.dead_zone)) / length)


@final
@dataclass(frozen=True)
class OwnDirections:
    """How one person's directions of a stick of two axes differ from the usual ones."""

    turn_rad: float = 0.0  # they push so far to the left of where others push for the same motion, rad
    mirrored: bool = False  # for them the second axis is upside down, before the turn

    @property
    def matrix(self) -> FloatArray:
        """(2, 2), orthogonal: from where others push the stick to where they do."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        up = -1.0 if self.mirrored else 1.0
        return np.array([[cos, -sin * up], [sin, cos * up]])

    def expected(self, usual: FloatArray) -> FloatArray:
        """The twist (6, 2), m/s and rad/s, that they expect of full pushes; others expect ``usual``."""
        _check_axes(usual.shape[1])
        return usual @ self.matrix.T


@final
@dataclass(frozen=True, eq=False)
class InOwnDirections:
    """Answers like another person, in one's own directions."""

    preference: Preference  # what others mean by the stick
    directions: OwnDirections  # how this person's directions differ

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, 2) by which they would ask for N motions, each in [-1, 1]."""
        usual = self.preference.inputs(motions)
        _check_axes(usual.shape[1])
        return np.clip(usual @ self.directions.matrix.T, -1.0, 1.0)


def _check_axes(axes: int) -> None:
    if axes != 2:
        raise UserError(f"Own directions are those of a stick of two axes, and this one has {axes}.")
