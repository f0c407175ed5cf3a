"""Circle: one arm moves back and forth along circles and between them (2-D latent action).

The circles share a centre and differ in radius. A demonstration goes in strokes, along its circle or
straight in and out to another, in turn, each at its own speed and for its own time.
"""

from typing import final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm_research.tasks.planar.motion import DEMONSTRATION_S, OneArm
from latentarm_research.tasks.planar.paths import STEP_S, Path, Timed
from latentarm_research.tasks.planar.resolved_rate import curled, plane_point

RADII_M = (0.06, 0.15)
"""Smallest and largest circle."""
SPEED_M_S = (0.05, 0.2)
STROKE_S = (0.4, 1.0)
"""Shortest and longest stroke."""

_STEPS = round(DEMONSTRATION_S / STEP_S)


@final
class Circle(OneArm):
    """Along circles about the nominal place of the tool, and between them."""

    name = "circle"
    words = "move along circles and between them"
    latent_dim = 2  # along a circle and between circles

    @property
    def centre(self) -> FloatArray:
        """Centre (2,) of the circles, m."""
        return plane_point(self.robot, curled(self.robot))

    def paths(self, count: int, rng: np.random.Generator) -> Path:
        """Strokes along circles and between them, in turn."""
        polar = np.array([_strokes(rng) for _ in range(count)])
        return Timed(lambda time: self._place(*polar[:, round(time / STEP_S)].T))

    def _place(self, radius: FloatArray, angle: FloatArray) -> FloatArray:
        return self.centre + radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _strokes(rng: np.random.Generator) -> FloatArray:
    """Radius, m, and angle, rad, at each step of one demonstration: (_STEPS + 1, 2)."""
    radius, angle = rng.uniform(*RADII_M), rng.uniform(0.0, 2 * np.pi)
    between = rng.random() < 0.5
    passed = [(radius, angle)]
    while len(passed) <= _STEPS:
        step = rng.uniform(*SPEED_M_S) * rng.choice([-1.0, 1.0]) * STEP_S
        for _ in range(round(rng.uniform(*STROKE_S) / STEP_S)):
            if between:
                if not RADII_M[0] <= radius + step <= RADII_M[1]:
                    step = -step
                radius += step
            else:
                angle += step / radius
            passed.append((radius, angle))
        between = not between
    return np.array(passed[: _STEPS + 1])
