"""Containers: cups and bowls of thin boxes, and grains packed into them."""

import numpy as np

from latentarm.errors import UserError
from latentarm.scene.thing import Interior, Part, Thing
from latentarm.types import FloatArray, Pose

_SIDES = 12
"""Boxes that the wall of a container is made of."""

_CLOSE = 1.02
"""Grains are packed with this much more than their diameter between their middles."""


def walls(
    radius_m: float, height_m: float, thickness_m: float, colour: tuple[float, float, float, float]
) -> tuple[tuple[Part, ...], Interior]:
    """The solids of an open container, its frame in the middle of its underside.

    Args:
        radius_m: of the largest upright cylinder in it, m.
        height_m: from its underside to its rim, m.
        thickness_m: of its wall and its floor, m.
        colour: of all of it.

    Returns:
        Its parts, and the room in it.
    """
    outside = radius_m + thickness_m
    floor = Part("cylinder", (outside, thickness_m / 2), (0.0, 0.0, thickness_m / 2), colour=colour)
    middle = radius_m + thickness_m / 2
    # As wide as a side of the polygon about the outer circle, so that no gap is left at the corners.
    half_width = outside * np.tan(np.pi / _SIDES)
    half_height = (height_m - thickness_m) / 2
    sides = [
        Part(
            "box",
            (thickness_m / 2, half_width, half_height),
            (middle * np.cos(angle), middle * np.sin(angle), thickness_m + half_height),
            (np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)),
            colour,
        )
        for angle in 2 * np.pi * np.arange(_SIDES) / _SIDES
    ]
    return (floor, *sides), Interior(radius_m, thickness_m, height_m)


def cup(
    name: str,
    pose: Pose,
    radius_m: float = 0.03,
    height_m: float = 0.09,
    *,
    mass_kg: float = 0.08,
    colour: tuple[float, float, float, float] = (0.36, 0.55, 0.75, 1.0),
) -> Thing:
    """A cup that can be gripped, its frame in the middle of its underside."""
    parts, interior = walls(radius_m, height_m, 0.003, colour)
    return Thing(name, parts, mass_kg, pose, friction=1.0, interior=interior)


def bowl(
    name: str,
    pose: Pose,
    radius_m: float = 0.07,
    height_m: float = 0.05,
    *,
    colour: tuple[float, float, float, float] = (0.93, 0.93, 0.95, 1.0),
) -> Thing:
    """A bowl that stays where it stands, its frame in the middle of its underside."""
    parts, interior = walls(radius_m, height_m, 0.004, colour)
    return Thing(name, parts, 0.5, pose, fixed=True, interior=interior)


def packed(container: Thing, count: int, radius_m: float) -> FloatArray:
    """Places of grains in a container, layer on layer.

    Args:
        container: has an interior.
        count: K, how many grains.
        radius_m: of a grain, m.

    Returns:
        (K, 3), in the base frame of the arm, m.

    Raises:
        UserError: it is no container, or they do not fit into it.
    """
    room = interior_of(container)
    step = 2.0 * _CLOSE * radius_m
    free = room.radius_m - _CLOSE * radius_m
    across = np.arange(-np.floor(free / step), np.floor(free / step) + 1) * step
    x, y = (one.ravel() for one in np.meshgrid(across, across))
    layer = np.stack([x, y], axis=1)[np.hypot(x, y) <= free]
    layers = int((room.top_m - room.bottom_m) / step)
    if not len(layer) or count > layers * len(layer):
        raise UserError(f"{count} grains do not fit into {container.name!r}: take fewer or smaller ones.")
    number = np.arange(count)
    height = room.bottom_m + (number // len(layer) + 0.5) * step
    local = np.column_stack([layer[number % len(layer)], height])
    return container.pose.position + local @ container.pose.rotation.T


def interior_of(container: Thing) -> Interior:
    """The room in a container.

    Raises:
        UserError: it is no container.
    """
    if container.interior is None:
        raise UserError(f"{container.name!r} is no container: nothing can be poured into it.")
    return container.interior
