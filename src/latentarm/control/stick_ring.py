"""The ring that is drawn about the tool: where every direction of the stick leads within a second."""

from typing import Final

import numpy as np

from latentarm.types import FloatArray

DIRECTIONS: Final = 32
"""Of a stick with two axes, counter-clockwise from the right."""

AHEAD_S: Final = 1.0
"""How far ahead the ring shows the tool, s."""

STRETCHES: Final = 6
"""Into how many equal stretches this time is cut; in each the action is constant."""


def full_pushes(axes: int) -> FloatArray:
    """A full push in every direction of the ring, (K, axes): for one axis right and left alone.

    A stick of more than two axes is one of two axes here, and the others rest.
    """
    if axes == 1:
        return np.array([[1.0], [-1.0]])
    pushes = np.zeros((DIRECTIONS, axes))
    angle = np.arange(DIRECTIONS) * (2.0 * np.pi / DIRECTIONS)
    pushes[:, 0], pushes[:, 1] = np.cos(angle), np.sin(angle)
    return pushes.round(12)
