"""Where things may stand."""

import numpy as np

from latentarm.core.types import FloatArray

Region = tuple[tuple[float, float], tuple[float, float]]
"""Lowest and highest x, lowest and highest y, m."""


def anywhere(region: Region, rng: np.random.Generator) -> FloatArray:
    """A place in a region, all of it as likely, (2,), m."""
    lower, upper = np.array(region).T
    return rng.uniform(lower, upper)
