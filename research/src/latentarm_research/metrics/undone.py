"""Undone motion: the share of the tool's path that is later retraced in reverse."""

from typing import Final

import numpy as np

from latentarm.core.types import FloatArray

SPACING_M: Final = 0.005  # way between two samples of the path, m
NEAR_M: Final = 0.015  # how near a later motion must pass to undo an earlier one, m
AGAINST: Final = -0.5  # cosine of the angle between the two, at most: from 120° on one undoes the other


def undone_share(
    position: FloatArray,  # (T, 3), places of the tool, m
) -> float:
    """Share of a path's length that is later gone back over, near by and the other way.

    A straight line has 0, a line there and back 0.5, and a circle led around twice 0.

    Returns:
        In [0, 1]; 0 for a path shorter than two samples of it.
    """
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(position, axis=0), axis=-1))])
    samples = int(way[-1] / SPACING_M) + 1
    if samples < 3:
        return 0.0
    at = np.linspace(0.0, way[-1], samples)
    places = np.stack([np.interp(at, way, axis) for axis in position.T], axis=-1)
    moved = np.diff(places, axis=0)
    # A corner that was cut between two samples may leave them in one place, without a direction.
    direction = moved / np.maximum(np.linalg.norm(moved, axis=-1, keepdims=True), np.finfo(float).tiny)
    middle = (places[1:] + places[:-1]) / 2.0
    undone = [
        bool(
            np.any(
                (np.linalg.norm(middle[index + 1 :] - middle[index], axis=-1) <= NEAR_M)
                & (direction[index + 1 :] @ direction[index] <= AGAINST)
            )
        )
        for index in range(len(middle))
    ]
    return float(np.mean(undone))
