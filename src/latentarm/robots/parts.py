"""Solids of things and of a fork in a MuJoCo model."""

from collections.abc import Sequence
from typing import Final

import mujoco
import numpy as np

from latentarm.robots.scene.thing import Part

_SHAPES: Final = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
}


def add_parts(body: mujoco.MjsBody, parts: Sequence[Part], mass_kg: float) -> list[mujoco.MjsGeom]:
    """Add solids to a body, with its mass spread evenly over their volumes; returns their geoms in order."""
    volumes = [_volume(part) for part in parts]
    return [
        body.add_geom(
            type=_SHAPES[part.shape],
            size=[*part.size, *([0.0] * (3 - len(part.size)))],
            pos=list(part.position),
            quat=list(part.quaternion),
            rgba=list(part.colour),
            mass=mass_kg * volume / sum(volumes),
        )
        for part, volume in zip(parts, volumes, strict=True)
    ]


def _volume(part: Part) -> float:
    size = part.size
    if part.shape == "box":
        return 8.0 * size[0] * size[1] * size[2]
    if part.shape == "cylinder":
        return 2.0 * np.pi * size[0] ** 2 * size[1]
    ball = 4.0 / 3.0 * np.pi * size[0] ** 3
    return ball if part.shape == "sphere" else ball + 2.0 * np.pi * size[0] ** 2 * size[1]
