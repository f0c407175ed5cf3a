"""The surfaces on which the gripper may put down what it holds."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final, TypeVar

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.obstacles import Box, HalfSpace

_Solid = TypeVar("_Solid", HalfSpace, Box)

_LEVEL: Final = 0.98  # a surface is level where the upward part of its unit normal is at least this


def level_face(solid: HalfSpace | Box) -> FloatArray | None:
    """The unit normal (3,) of a solid's level upper face, or None if it has no such face."""
    if isinstance(solid, HalfSpace):
        up = solid.normal
    else:
        up = solid.rotation[:, np.abs(solid.rotation[2]).argmax()]
        up = up * np.sign(up[2])
    return up if up[2] >= _LEVEL else None


def beneath(solids: Sequence[_Solid], clearance: float) -> Iterator[_Solid]:
    """Solids, so placed that a held thing which keeps the clearance, m, from them may touch what is level.

    A level plane and the level top of a box lie lower by the clearance. The box's sides stand as they are, up
    to its edges: an edge could pass between the capsules that stand for a thing, see `holding`.
    """
    for solid in solids:
        if (up := level_face(solid)) is None:
            yield solid
        elif isinstance(solid, HalfSpace):
            yield replace(solid, point=solid.point - clearance * up)
        else:
            half, upright = solid.half_extents, np.abs(solid.rotation.T @ up) > 0.5
            lower = np.where(upright, np.maximum(half - 0.5 * clearance, 0.0), half)
            down = clearance - (half - lower)[upright].sum()
            yield replace(solid, centre=solid.centre - down * up, half_extents=lower)
            for side in np.flatnonzero(~upright):
                out = solid.rotation[:, side] * half[side]
                wall = np.where(np.arange(3) == side, 0.0, half)
                yield replace(solid, centre=solid.centre + out, half_extents=wall)
                yield replace(solid, centre=solid.centre - out, half_extents=wall)
