"""Keeps joints within their position limits."""

from typing import final

import numpy as np

from latentarm.control.safety.bounds import BUFFER_RAD
from latentarm.control.safety.filter import SafetyFilter, Situation
from latentarm.control.safety.small import largest, some
from latentarm.types import FloatArray


@final
class JointPosition(SafetyFilter):
    """Slows each joint down before its limit and stops it there; the other joints go on.

    The speed towards a limit is at most the distance left times ``damping_per_s``, which ordinary motion
    can follow. Past a limit (the arm was put there by hand) a joint may only move back.
    """

    @property
    def name(self) -> str:
        """See the base class."""
        return "joint position"

    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray:
        """See the base class."""
        bounds = situation.bounds
        if (situation.nearest_limit - BUFFER_RAD) * bounds.damping_per_s >= largest(np.abs(velocity)):
            return velocity
        down = (situation.room[0] + BUFFER_RAD) * bounds.damping_per_s
        up = (situation.room[1] - BUFFER_RAD) * bounds.damping_per_s
        clipped = np.minimum(np.maximum(velocity, np.minimum(down, 0.0)), np.maximum(up, 0.0))
        return clipped if some(clipped != velocity) else velocity
