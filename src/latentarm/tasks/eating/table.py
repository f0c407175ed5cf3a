"""Dishes and food on the table in the tasks with a fork, and the fork over them."""

from typing import Final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.thing import Food, Part, Thing

STAND_M: Final = 0.06  # height of dishes over the table: the arm keeps clear of its top
PLATE_RADIUS_M: Final = 0.10
PLATE_M: Final = 0.012  # thickness of a plate, m
MARSHMALLOW: Final = Food(pierce_n=1.0, depth_m=0.010, grip_n=4.0)
"""Chosen: it takes about a newton to enter soft food, and a pull of a few to take it off."""

MARSHMALLOW_RADIUS_M: Final = 0.014
MARSHMALLOW_HALF_M: Final = 0.014
_WOOD: Final = (0.62, 0.47, 0.33, 1.0)
_CHINA: Final = (0.95, 0.95, 0.97, 1.0)


def at(x: float, y: float, z: float, turn_rad: float = 0.0) -> Pose:
    """An upright pose, turned about the vertical."""
    cos, sin = np.cos(turn_rad), np.sin(turn_rad)
    return Pose(np.array([x, y, z]), np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]))


def plate(name: str, x: float, y: float, radius_m: float = PLATE_RADIUS_M) -> Thing:
    """A fixed plate on a stand, with its frame in the middle of its top."""
    disc = Part("cylinder", (radius_m, PLATE_M / 2), (0.0, 0.0, -PLATE_M / 2), colour=_CHINA)
    half = (STAND_M - PLATE_M) / 2
    stand = Part("cylinder", (0.6 * radius_m, half), (0.0, 0.0, -PLATE_M - half), colour=_WOOD)
    return Thing(name, (disc, stand), mass_kg=1.0, pose=at(x, y, STAND_M), fixed=True)


def marshmallow(name: str, x: float, y: float, turn_rad: float = 0.0) -> Thing:
    """A marshmallow that stands on a plate, with its frame in its middle."""
    body = Part("cylinder", (MARSHMALLOW_RADIUS_M, MARSHMALLOW_HALF_M), colour=(0.98, 0.93, 0.90, 1.0))
    pose = at(x, y, STAND_M + MARSHMALLOW_HALF_M, turn_rad)
    return Thing(name, (body,), mass_kg=0.007, pose=pose, friction=0.9, food=MARSHMALLOW)


def fork(place: FloatArray, height_m: float, turn_rad: float | None = None, tilt_rad: float = 0.0) -> Pose:
    """A pose of a fork with its tip at a height over a place (3,), m.

    Its back faces the bearing ``turn_rad``, by default away from the arm's base; its tines stand in a row
    across that. ``tilt_rad`` leans it from upright, its tip towards the bearing.
    """
    bearing = float(np.arctan2(place[1], place[0])) if turn_rad is None else turn_rad
    out = np.array([np.cos(bearing), np.sin(bearing), 0.0])
    side = np.array([out[1], -out[0], 0.0])
    up = np.array([0.0, 0.0, 1.0])
    cos, sin = np.cos(tilt_rad), np.sin(tilt_rad)
    rotation = np.array([cos * out + sin * up, side, sin * out - cos * up]).T
    return Pose(place + height_m * up, rotation)
