"""Food and dishes of the table-top task, for display only."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from latentarm.core.types import Pose
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Part, Thing

_PLATE_RADIUS_M: Final = 0.06
_PLATE_HALF_M: Final = 0.005
_HALF_M: Final = 0.014  # half the height of every item
_CHINA: Final = (0.95, 0.95, 0.97, 1.0)
_WOOD: Final = (0.62, 0.47, 0.33, 1.0)
_ALONG_Y: Final = (float(np.sqrt(0.5)), float(np.sqrt(0.5)), 0.0, 0.0)
_FOOD: Final[Mapping[str, Part]] = {
    "carrot": Part("capsule", (_HALF_M, 0.025), quaternion=_ALONG_Y, colour=(0.93, 0.45, 0.10, 1.0)),
    "tofu": Part("box", (0.020, 0.020, _HALF_M), colour=(0.93, 0.86, 0.66, 1.0)),
    "melon": Part("sphere", (_HALF_M,), colour=(0.35, 0.62, 0.25, 1.0)),
}


def food_on_dishes(items: Mapping[str, tuple[float, float]], height_m: float) -> Scene:
    """Each item on a dish of its own: carrot, tofu or melon by x and y, m, its middle at ``height_m``."""
    dishes = (_dish(name, *place, height_m - _HALF_M) for name, place in items.items())
    return Scene((*dishes, *(_item(name, *place, height_m) for name, place in items.items())))


def _dish(item: str, x: float, y: float, top_m: float) -> Thing:
    half = (top_m - 2 * _PLATE_HALF_M) / 2
    disc = Part("cylinder", (_PLATE_RADIUS_M, _PLATE_HALF_M), (0.0, 0.0, -_PLATE_HALF_M), colour=_CHINA)
    below = -2 * _PLATE_HALF_M - half
    stand = Part("cylinder", (0.5 * _PLATE_RADIUS_M, half), (0.0, 0.0, below), colour=_WOOD)
    return Thing(f"{item} dish", (disc, stand), 0.5, Pose(np.array([x, y, top_m]), np.eye(3)), fixed=True)


def _item(name: str, x: float, y: float, height_m: float) -> Thing:
    return Thing(name, (_FOOD[name],), 0.02, Pose(np.array([x, y, height_m]), np.eye(3)))
