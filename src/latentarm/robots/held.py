"""Held things as parts of an arm's shape."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.chain import Capsules
from latentarm.robots.kinematics.obstacles import Box
from latentarm.robots.robot import Robot

_SIDES: Final = np.array([[0.0, 0.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])
"""Where the rods of a box lie across it: its core and its long edges."""


def holding(robot: Robot, things: Sequence[Box]) -> Robot:
    """The robot, which holds nothing, with things in its hand; boxes in the frame of its first tool.

    Five capsules stand for a thing: the four long edges of its box, which have no radius, and a core as thick
    as the box is at its narrowest. Above a plane they are exactly as high as the box. The box of a cup, 7 cm
    wide and 9 cm high, reaches out of them by at most 18 mm, less than the usual clearance. They are watched
    against all links but the tool's own and the one before it.
    """
    if not things:
        return robot
    own, tool = robot.capsules, robot.chain.tools[0]
    starts, ends, radii = (np.concatenate(part) for part in zip(*map(_rods, things), strict=True))
    turn, place = tool.transform[:3, :3], tool.transform[:3, 3]
    near = np.isin(own.link, [tool.link, robot.chain.parent[tool.link]])
    added = len(own) + np.arange(len(radii))
    pairs = np.stack(np.meshgrid(np.flatnonzero(~near), added), axis=-1).reshape(-1, 2)
    capsules = Capsules(
        own.name + tuple(thing.name for thing in things for _ in _SIDES),
        np.concatenate([own.link, np.full(len(added), tool.link)]),
        np.concatenate([own.start, starts @ turn.T + place]),
        np.concatenate([own.end, ends @ turn.T + place]),
        np.concatenate([own.radius, radii]),
    )
    self_pairs = np.concatenate([robot.self_pairs, pairs])
    return replace(robot, capsules=capsules, self_pairs=self_pairs, held=len(added))


def _rods(box: Box) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Starts and ends (5, 3), m, and radii (5,), m."""
    order = np.argsort(box.half_extents)
    narrow, wide, long = (box.rotation[:, axis] * box.half_extents[axis] for axis in order)
    middle = box.centre + _SIDES @ np.stack([narrow, wide])
    radius = np.zeros(len(_SIDES))
    radius[0] = box.half_extents[order[0]]
    half = np.outer(1.0 - radius / box.half_extents[order[2]], long)
    return middle - half, middle + half, radius
