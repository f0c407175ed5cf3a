"""Validation of obstacles for the safety filters, and common obstacles by name."""

from dataclasses import replace
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere

_FAR_M = 10.0
_LARGE_M = 100.0  # places farther away, and larger things, are not in metres


def table(height: float) -> HalfSpace:
    """A table top (or floor): everything below ``height``, m, base frame; UserError where not finite."""
    plane = HalfSpace(name="table", point=np.array([0.0, 0.0, height]), normal=np.array([0.0, 0.0, 1.0]))
    checked_obstacle(plane)
    return plane


def checked_obstacle(obstacle: object) -> Obstacle:
    """The obstacle with float arrays, validated.

    Raises UserError where a figure is not finite or absurd, a size is not positive, a normal is not of unit
    length, or a rotation is not one.
    """
    # An obstacle without a case below would be ignored silently.
    if not isinstance(obstacle, Obstacle):
        raise UserError(f"{obstacle!r} is not an obstacle: use HalfSpace, Sphere, Capsule or Box.")
    return checked_shape(obstacle, f"The obstacle {obstacle.name!r}")


def checked_shape(obstacle: Obstacle, what: str) -> Obstacle:
    """The shape with float arrays, validated as by `checked_obstacle`; messages begin with ``what``."""
    match obstacle:
        case HalfSpace():
            point = _point(what, "point", obstacle.point)
            return replace(obstacle, point=point, normal=_unit(what, obstacle.normal))
        case Sphere():
            centre = _point(what, "centre", obstacle.centre)
            return replace(obstacle, centre=centre, radius=_size(what, "radius", obstacle.radius))
        case Capsule():
            start, end = _point(what, "start", obstacle.start), _point(what, "end", obstacle.end)
            radius = _size(what, "radius", obstacle.radius)
            return replace(obstacle, start=start, end=end, radius=radius)
        case Box():
            extents = _point(what, "half_extents", obstacle.half_extents)
            for extent in extents:
                _size(what, "half_extents", float(extent))
            centre, rotation = _point(what, "centre", obstacle.centre), _rotation(what, obstacle.rotation)
            return replace(obstacle, centre=centre, rotation=rotation, half_extents=extents)


def is_number(value: object) -> TypeGuard[float]:
    """Whether the value is a real number, and no truth value."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def as_array(value: object) -> NDArray[Any]:
    """The value as an array; of objects where it is ragged."""
    try:
        return np.asarray(value)
    except ValueError:
        return np.asarray(None)


def _numbers(what: str, field: str, value: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    given = as_array(value)
    if given.shape != shape or given.dtype.kind not in "iuf" or not np.isfinite(given).all():
        count = "×".join(map(str, shape))
        raise UserError(f"{what} needs {count} finite numbers as its {field}.")
    return given.astype(np.float64)


def _point(what: str, field: str, value: FloatArray) -> FloatArray:
    point = _numbers(what, field, value, (3,))
    if np.abs(point).max() > _FAR_M:
        raise UserError(f"{what} has its {field} over {_FAR_M:g} m away: give metres.")
    return point


def _unit(what: str, value: FloatArray) -> FloatArray:
    normal = _numbers(what, "normal", value, (3,))
    if abs(float(normal @ normal) - 1.0) > 1e-6:
        raise UserError(f"{what} needs a normal of length 1.")
    return normal / np.sqrt(normal @ normal)


def _rotation(what: str, value: FloatArray) -> FloatArray:
    rotation = _numbers(what, "rotation", value, (3, 3))
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > 1e-6 or np.linalg.det(rotation) < 0.0:
        raise UserError(f"{what} needs a rotation matrix as its rotation.")
    return rotation


def _size(what: str, field: str, value: object) -> float:
    if not is_number(value):
        raise UserError(f"{what} needs a number as its {field}.")
    if not 0.0 < value <= _LARGE_M:
        raise UserError(f"{what} has {field} {value}: it must be above 0 and at most {_LARGE_M:g} m.")
    return float(value)
