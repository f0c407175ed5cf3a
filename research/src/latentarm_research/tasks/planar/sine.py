"""Sine: one arm moves its tool back and forth along a sine wave (1-D latent action).

The wave has three half-periods about the tool's place in the nominal posture. It is so flat that what it asks
of the joints is mostly the same everywhere; what differs, with the place and with the posture, is what PCA
loses.
"""

from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.tasks.planar.motion import DEMONSTRATION_S, OneArm
from latentarm_research.tasks.planar.paths import Paced, Path
from latentarm_research.tasks.planar.resolved_rate import curled, plane_point

AMPLITUDE_M: Final = 0.01
WAVELENGTH_M: Final = 0.2
HALF_LENGTH_M: Final = 0.15
SPEED_RAD_S: Final = 0.4
"""SD of the joint speed."""


@final
class Sine(OneArm):
    """Along ``y = A sin(2 pi x / wavelength)`` about the nominal place of the tool."""

    name = "sine"
    words = "move along the sine wave"
    latent_dim = 1  # along the wave

    def curve(self, along: FloatArray) -> FloatArray:
        """Points (..., 2) of the wave, m, at distances (...,) to the right of its middle, m."""
        wave = AMPLITUDE_M * np.sin(2 * np.pi * along / WAVELENGTH_M)
        return plane_point(self.robot, curled(self.robot)) + np.stack([along, wave], axis=-1)

    def paths(self, count: int, rng: np.random.Generator) -> Path:
        """Back and forth over the wave: each stroke has its own joint speed, so that it tells no place."""
        begin = rng.uniform(-HALF_LENGTH_M, HALF_LENGTH_M, count)
        return Paced(self.curve, begin, (-HALF_LENGTH_M, HALF_LENGTH_M), SPEED_RAD_S, DEMONSTRATION_S, rng)
