"""Containers made of thin boxes, and the grains in them."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.thing import Interior, Part

Colour = tuple[float, float, float, float]
WALL_M: Final = 0.003  # of walls and floors: no grain passes through one within a time step
SIDES: Final = 12  # walls of a round container; four of them stand across x and y, where a gripper takes hold
_CHINA: Final = (0.92, 0.93, 0.95, 1.0)
_APART: Final = 1.02


@final
@dataclass(frozen=True)
class Container:
    """A container's parts and the room in it; its frame lies in the middle of its underside, z up."""

    parts: tuple[Part, ...]
    interior: Interior


def cup(
    radius_m: float = 0.032, height_m: float = 0.09, colour: Colour = _CHINA, floor_m: float = WALL_M
) -> Container:
    """An upright cup; colours are red, green, blue, opacity.

    A gripper must open by more than ``2 * (radius_m + WALL_M)`` to take it. A thick floor makes the room in
    it shallow.
    """
    return _round(radius_m, height_m, 0.0, colour, floor_m)


def bowl(radius_m: float = 0.06, height_m: float = 0.05, colour: Colour = _CHINA) -> Container:
    """A bowl, wider at its rim; ``radius_m`` is the floor's."""
    return _round(radius_m, height_m, np.deg2rad(20.0), colour)


def _round(
    radius_m: float, height_m: float, flare_rad: float, colour: Colour, floor_m: float = WALL_M
) -> Container:
    half = WALL_M / 2.0
    parts = [Part("cylinder", (radius_m + WALL_M, floor_m / 2.0), (0.0, 0.0, floor_m / 2.0), colour=colour)]
    lean = height_m * np.tan(flare_rad)
    slant = height_m / np.cos(flare_rad)
    width = (radius_m + WALL_M + lean) * np.tan(np.pi / SIDES)
    for side in range(SIDES):
        turn = Rotation.from_euler("ZY", [2.0 * np.pi * side / SIDES, flare_rad])
        out = Rotation.from_euler("Z", 2.0 * np.pi * side / SIDES)
        middle = out.apply([radius_m + half / np.cos(flare_rad) + lean / 2.0, 0.0, height_m / 2.0])
        size = (half, float(width), float(slant / 2.0))
        place = (float(middle[0]), float(middle[1]), float(middle[2]))
        parts.append(Part("box", size, place, _quaternion(turn), colour))
    return Container(tuple(parts), Interior(float(radius_m + lean), floor_m - half, height_m))


def _quaternion(turn: Rotation) -> tuple[float, float, float, float]:
    w, x, y, z = (float(one) for one in turn.as_quat(scalar_first=True))
    return w, x, y, z


def packed(room: Interior, pose: Pose, count: int, radius_m: float) -> FloatArray:
    """Middles (count, 3), m, of grains that fill an upright cylinder from its floor up without contact."""
    step = 2.0 * _APART * radius_m
    most = room.radius_m - _APART * radius_m
    layer = _rings(most, step) if most >= 0.0 else np.zeros((0, 2))
    layers = int((room.top_m - room.bottom_m - step) / step) + 1
    if len(layer) * max(layers, 0) < count:
        raise UserError(f"{count} grains of {radius_m:g} m do not fit into a room {room.radius_m:g} m wide.")
    heights = room.bottom_m + (np.arange(layers) + 0.5) * step
    places = np.array([[x, y, z] for z in heights for x, y in layer])[:count]
    return places @ pose.rotation.T + pose.position


def _rings(most_m: float, step_m: float) -> FloatArray:
    """Places (K, 2) in a circle, at least a step apart: its middle and full rings about it."""
    places = [np.zeros((1, 2))]
    for radius in np.arange(1, int(most_m / step_m) + 1) * step_m:
        count = int(np.pi / np.arcsin(0.5 * step_m / radius) + 1e-9)
        angle = 2.0 * np.pi * np.arange(count) / count
        places.append(radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1))
    return np.concatenate(places)
