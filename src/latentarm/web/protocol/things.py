"""The things about the arm for pages: their shapes once, and their poses repeatedly."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.pose_rows import thing_rows
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Part
from latentarm.web.protocol.report import PoseRow, SeenThing, Things

_DIGITS: Final = 4
"""Positions are sent to a tenth of a millimetre, so that things at rest need not be sent again."""

_SIZES: Final = 3  # numbers in the size of a geom, as in MuJoCo


def described(scene: Scene) -> dict[str, object]:
    """The part of ``/scene.json`` about things.

    ``things``, each with its name, its ``pose`` at first, whether it is ``fixed`` there, ``geoms`` like those
    of the robot's bodies, and ``soft`` ones, which give way to everything; and ``grains``, each kind with its
    name, ``radius`` (m), ``rgba`` and first ``positions`` (m).
    """
    first = _rows({thing.name: thing.pose for thing in scene.things}, scene.names)
    return {
        "things": [
            {
                "name": thing.name,
                "pose": pose,
                "fixed": thing.fixed,
                "geoms": [_geom(part) for part in thing.parts],
                "soft": [_geom(part) for part in thing.soft],
            }
            for thing, pose in zip(scene.things, first, strict=True)
        ],
        "grains": [
            {
                "name": grains.name,
                "radius": grains.radius_m,
                "rgba": list(grains.colour),
                "positions": _rounded(grains.positions.ravel()),
            }
            for grains in scene.grains
        ],
    }


def things_at(
    scene: Scene, poses: Mapping[str, Pose], grains: Mapping[str, FloatArray], seen: Sequence[SeenThing]
) -> Things:
    """Where everything is, in the order of the scene; ``grains`` (K, 3) by the grains' name, m."""
    return Things(
        poses=tuple(_rows(poses, scene.names)),
        grains=tuple(tuple(_rounded(grains[one.name].ravel())) for one in scene.grains),
        seen=tuple(seen),
    )


def _geom(part: Part) -> dict[str, object]:
    return {
        "type": part.shape,
        "size": [*part.size, *([0.0] * (_SIZES - len(part.size)))],
        "pos": list(part.position),
        "quat": list(part.quaternion),
        "rgba": list(part.colour),
        "mesh": None,
    }


def _rows(poses: Mapping[str, Pose], names: Sequence[str]) -> list[PoseRow]:
    rows = np.round(thing_rows(poses, names), _DIGITS).tolist()
    return [(x, y, z, w, i, j, k) for x, y, z, w, i, j, k in rows]


def _rounded(values: FloatArray) -> list[float]:
    return np.round(values, _DIGITS).tolist()
