"""The ring drawn about the tool: where every direction of the stick leads within a second."""

from typing import Final

import numpy as np

from latentarm.core.types import FloatArray

DIRECTIONS: Final = 32  # of a stick with two axes, counter-clockwise from the right
AHEAD_S: Final = 1.0  # how far ahead the ring shows the tool, s
STRETCHES: Final = 6  # this time is cut into so many equal stretches; the action is constant in each


def full_pushes(axes: int) -> FloatArray:
    """A full push in every direction of the ring, (K, axes), and after these both ways along other axes.

    A stick of one axis has no ring. Of more axes, the first two are a stick and each other one a lever.
    """
    if axes == 1:
        return np.array([[1.0], [-1.0]])
    angle = np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1).round(12) @ np.eye(2, axes)
    levers = np.eye(axes)[2:]
    return np.concatenate([ring, levers, -levers])
