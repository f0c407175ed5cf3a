"""Reach: one arm goes from a start to somewhere in a goal region (1-D latent action).

Straight lines at constant tool speed, from anywhere on the start side to anywhere in the goal region: where
to, not how fast, is all that the latent action has to say. Starts are spread as widely as goals are, so that
at every place on the way some demonstrations bear left and others right; were all of them to begin in one
point, the place alone would tell the rest of the way.
"""

from typing import final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.tasks.planar.motion import OneArm
from latentarm_research.tasks.planar.paths import Path, Timed
from latentarm_research.tasks.planar.resolved_rate import curled, plane_point

DISTANCE_M = 0.3
"""From the middle of the starts to the middle of the goal region, along x."""
WIDTH_M = 0.2
"""Of the starts and of the goal region, along y."""
DURATION_S = 2.0
"""Of every demonstration: the tool moves at about 0.15 m/s."""
DEPTH_M = 0.05
"""Of the goal region, along x."""


@final
class ReachRegion(OneArm):
    """From a start to any place of a goal region."""

    name = "reach"
    words = "reach into the goal region"
    latent_dim = 1  # to which part of the region
    duration_s = DURATION_S

    @property
    def region(self) -> FloatArray:
        """The closed outline (5, 2) of the goal region, m."""
        corner = np.array([[-1, -1], [-1, 1], [1, 1], [1, -1], [-1, -1]])
        return self._goal + corner * (DEPTH_M / 2, WIDTH_M / 2)

    def sample_goals(self, count: int, rng: np.random.Generator) -> FloatArray:
        """Places (count, 2) in the goal region, m."""
        offset = rng.uniform(-0.5, 0.5, (count, 2)) * (DEPTH_M, WIDTH_M)
        return self._goal + offset

    def sample_starts(self, count: int, rng: np.random.Generator) -> FloatArray:
        """Places (count, 2) to begin from, m."""
        along_side = rng.uniform(-0.5, 0.5, count) * WIDTH_M
        return self._middle + np.stack([np.full(count, -DISTANCE_M / 2), along_side], axis=-1)

    def paths(self, count: int, rng: np.random.Generator) -> Path:
        """Straight from a start to a place in the goal region."""
        start, goal = self.sample_starts(count, rng), self.sample_goals(count, rng)
        return Timed(lambda time: start + (goal - start) * time / DURATION_S)

    @property
    def _middle(self) -> FloatArray:
        return plane_point(self.robot, curled(self.robot))

    @property
    def _goal(self) -> FloatArray:
        return self._middle + np.array([DISTANCE_M / 2, 0.0])
