"""Further meanings of the axes of the stick, and people who answer imprecisely."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from latentarm.alignment.answers import Motions
from latentarm.alignment.preference import Preference
from latentarm.core.types import BoolArray, FloatArray
from latentarm.robots.kinematics.chain import Chain
from latentarm.robots.kinematics.rotations import pose_error


@final
@dataclass(frozen=True, eq=False)
class HeightAndTilt:
    """A simulated person for whom one axis of the stick is up, and the other tilts about the base's x axis.

    They ignore all other motion of the tool.
    """

    chain: Chain  # the arm, of which the first tool counts
    speed_m_s: float  # up, for which they would push all the way, m/s
    turn_rad_s: float  # the same of the tilt, rad/s

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, d) by which they would ask for N motions."""
        change = pose_error(self.chain.forward(motions.start), self.chain.forward(motions.end))
        wanted = change[:, [2, 3]] / (np.array([self.speed_m_s, self.turn_rad_s]) * motions.duration_s)
        return np.clip(wanted, -1.0, 1.0)


@final
@dataclass(frozen=True, eq=False)
class ByPlace:
    """A simulated person whose preference depends on the place."""

    chain: Chain  # the arm, of which the first tool counts
    is_there: Callable[[FloatArray], BoolArray]  # whether places (N, 3), m, are the place, (N,)
    there: Preference  # for motions that begin there
    elsewhere: Preference

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, d) by which they would ask for N motions."""
        there = self.is_there(self.chain.forward(motions.start).position)
        return np.where(there[:, None], self.there.inputs(motions), self.elsewhere.inputs(motions))


@final
@dataclass(frozen=True, eq=False)
class Imprecise:
    """A simulated person whose deflection of each axis varies randomly."""

    preference: Preference
    variation: float  # coefficient of variation, the SD of an answer as a share of it
    rng: np.random.Generator  # source of the chances; each call draws anew

    def inputs(self, motions: Motions) -> FloatArray:
        """The inputs (N, d) by which they would ask for N motions."""
        meant = self.preference.inputs(motions)
        pushed = meant * (1.0 + self.variation * self.rng.normal(size=meant.shape))
        return np.clip(pushed, -1.0, 1.0)
