"""A belief by nearness: a goal is likely where the action leads nearer to it."""

import numpy as np

from latentarm.assistance.belief import Belief
from latentarm.core.types import FloatArray

PER_RAD = 8.0
"""How much it counts that an action leads 1 rad nearer."""


class NearnessBelief(Belief):
    """Compares what an action alone would change over one period."""

    def log_likelihood(self, state: FloatArray, actions: FloatArray) -> FloatArray:
        before = self.goals - state[..., None, :]
        after = before - self.period_s * actions[..., :1, :]
        return -PER_RAD * (np.linalg.norm(after, axis=-1) - np.linalg.norm(before, axis=-1))
