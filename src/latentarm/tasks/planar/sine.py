"""Sine: one arm moves its tool back and forth along a sine wave (1-D latent action).

The wave has three half-periods and a slope of up to 40 degrees, so that no single joint velocity serves all
of it, and lies about the tool's place in the nominal posture. Speeds vary within and between demonstrations.
"""

from typing import final

import numpy as np

from latentarm.robots.planar import planar
from latentarm.tasks.planar.motion import BACK_AND_FORTH_S, POSTURE_SPREAD_RAD, PlanarMotion
from latentarm.tasks.planar.resolved_rate import curled, follow, plane_point
from latentarm.types import Demonstrations, FloatArray

AMPLITUDE_M = 0.04
WAVELENGTH_M = 0.3
HALF_LENGTH_M = 0.225
SWING_RAD_S = (0.6, 1.2)
"""Slowest and fastest angular frequency of the back-and-forth."""


@final
class Sine(PlanarMotion):
    """Along ``y = A sin(2 pi x / wavelength)`` about the nominal place of the tool."""

    def __init__(self) -> None:
        super().__init__(planar(5))

    @property
    def name(self) -> str:
        """``sine``."""
        return "sine"

    @property
    def latent_dim(self) -> int:
        """1: along the wave."""
        return 1

    @property
    def guides(self) -> tuple[FloatArray, ...]:
        """The wave."""
        return (self.curve(np.linspace(-HALF_LENGTH_M, HALF_LENGTH_M, 200)),)

    def curve(self, along: FloatArray) -> FloatArray:
        """Points (..., 2) of the wave, m, at distances (...,) to the right of its middle, m."""
        wave = AMPLITUDE_M * np.sin(2 * np.pi * along / WAVELENGTH_M)
        return plane_point(self.robot, curled(self.robot)) + np.stack([along, wave], axis=-1)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Back and forth over a part of the wave.

        Raises:
            UserError: fewer than one episode is asked for.
        """
        count = max(episodes, 0)
        reach = rng.uniform(0.4, 1.0, count) * HALF_LENGTH_M
        middle = rng.uniform(-1.0, 1.0, count) * (HALF_LENGTH_M - reach)
        swing = rng.uniform(*SWING_RAD_S, count)
        phase = rng.uniform(0.0, 2 * np.pi, count)
        start = curled(self.robot) + rng.normal(0.0, POSTURE_SPREAD_RAD, (count, self.robot.dof))
        return follow(
            self.robot,
            start,
            lambda time: self.curve(middle + reach * np.sin(swing * time + phase)),
            lambda state: plane_point(self.robot, state),
            lambda state: self.robot.chain.jacobian(state)[..., :2, :],
            BACK_AND_FORTH_S,
            "move along the sine wave",
        )
