"""When an arm moves and when it stands still, for training, measuring and driving alike."""

from typing import Final

import numpy as np

from latentarm.core.types import FloatArray

STILL_RAD_S: Final = 0.01  # a slower joint stands still; the same figure ends a stop of the real arm


def moving_range(state: FloatArray, timestamp: FloatArray) -> tuple[int, int]:
    """Samples from the still arm before the motion to the one after; empty without any motion."""
    speed = np.abs(np.diff(state, axis=0)).max(axis=1) / np.diff(timestamp)
    steps = np.flatnonzero(speed > STILL_RAD_S)
    return (int(steps[0]), int(steps[-1]) + 2) if len(steps) else (0, 0)
