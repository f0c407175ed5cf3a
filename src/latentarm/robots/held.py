"""Held things as parts of an arm's shape."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, final

import numpy as np

from latentarm.robots.kinematics.chain import Capsules
from latentarm.robots.kinematics.obstacles import Box

if TYPE_CHECKING:
    from latentarm.robots.robot import Robot

_SIDES: Final = np.array([[0.0, 0.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])
"""Where the rods of a box lie across it: its core and its long edges."""


@final
@dataclass(frozen=True, eq=False)
class Held:
    """A thing that moves with the tool."""

    box: Box  # about it, in the tool's frame, with the thing's name
    mass_kg: float
    mounted: bool = False  # whether it stays on the arm, and is never put down


def holding(robot: "Robot", things: Sequence[Held]) -> "Robot":
    """The robot, which holds nothing, with things at its first tool.

    Five capsules stand for a thing: the four long edges of its box, which have no radius, and a core as thick
    as the box is at its narrowest. Above a plane they are exactly as high as the box. The box of a cup, 7 cm
    wide and 9 cm high, reaches out of them by at most 18 mm, less than the usual clearance. They are watched
    against all links but the tool's own and the one before it.
    """
    if not things:
        return robot
    things = sorted(things, key=lambda thing: not thing.mounted)
    own, chain = robot.capsules, robot.chain
    tool = chain.tools[0]
    near = (tool.link, int(chain.parent[tool.link]))
    starts, ends, radii = zip(*(_rods(thing.box) for thing in things), strict=True)
    turn, place = tool.transform[:3, :3], tool.transform[:3, 3]
    radius = np.concatenate([own.radius, *radii])
    added = np.arange(len(own), len(radius))
    watched = [index for index, link in enumerate(own.link.tolist()) if link not in near]
    pairs = np.stack(np.meshgrid(watched, added), axis=-1).reshape(-1, 2)
    capsules = Capsules(
        own.name + tuple(thing.box.name for thing in things for _ in _SIDES),
        np.concatenate([own.link, np.full(len(added), tool.link)]),
        np.concatenate([own.start, np.concatenate(starts) @ turn.T + place]),
        np.concatenate([own.end, np.concatenate(ends) @ turn.T + place]),
        radius,
    )
    self_pairs = np.concatenate([robot.self_pairs, pairs])
    put_down = len(_SIDES) * sum(not thing.mounted for thing in things)
    return replace(robot, capsules=capsules, self_pairs=self_pairs, held=put_down)


def _rods(box: Box) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Starts and ends (5, 3), m, and radii (5,), m."""
    order = np.argsort(box.half_extents)
    narrow, wide, long = (box.rotation[:, axis] * box.half_extents[axis] for axis in order)
    middle = box.centre + _SIDES @ np.stack([narrow, wide])
    radius = np.zeros(len(_SIDES))
    radius[0] = box.half_extents[order[0]]
    half = np.outer(1.0 - radius / box.half_extents[order[2]], long)
    return middle - half, middle + half, radius
