"""The counter with cups and bowls, and the hand over it."""

from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.scene.containers import WALL_M, Colour, bowl, cup, packed
from latentarm.robots.scene.thing import Grains, Part, Thing
from latentarm.tasks.eating.table import at

TOP_M: Final = 0.28  # of the counter in the base frame: a Panda can tilt its load there
COUNTER_M: Final = ((0.44, 0.80), (-0.45, 0.45))  # extent along x and y
PITCH_RAD: Final = -0.9  # of the hand above the horizontal: it can pour to either side from here
CUP_RADIUS_M: Final = 0.025
CUP_HEIGHT_M: Final = 0.08
GRIP_M: Final = 0.064  # height of the fingers over a cup's underside: the palm stays clear of its rim
BOWL_RADIUS_M: Final = 0.055
BOWL_HEIGHT_M: Final = 0.05
GRAIN_RADIUS_M: Final = 0.005
GRAIN_KG: Final = 4e-4
POSTURE_RAD: Final = (0.0, -0.5, 0.0, -2.3, 0.0, 2.2, np.pi / 4)
"""Start of the search for configurations: the hand before the chest, pointing out and down."""

FLOUR: Final = (0.9, 0.85, 0.7, 1.0)
_BLUE: Final = (0.36, 0.55, 0.75, 1.0)
_WOOD: Final = (0.55, 0.42, 0.30, 1.0)


def counter() -> Thing:
    """The counter, with its frame in the middle of its top."""
    (x0, x1), (y0, y1) = COUNTER_M
    half = ((x1 - x0) / 2, (y1 - y0) / 2, TOP_M / 2)
    block = Part("box", half, (0.0, 0.0, -TOP_M / 2), colour=_WOOD)
    return Thing("counter", (block,), 20.0, at((x0 + x1) / 2, (y0 + y1) / 2, TOP_M), fixed=True)


def counter_cup(
    name: str, x: float, y: float, colour: Colour = _BLUE, up_m: float = 0.0, floor_m: float = WALL_M
) -> Thing:
    """A cup on the counter, or on something that stands on it."""
    made = cup(CUP_RADIUS_M, CUP_HEIGHT_M, colour, floor_m)
    return Thing(name, made.parts, 0.06, at(x, y, TOP_M + up_m), friction=1.0, interior=made.interior)


def counter_bowl(name: str, x: float, y: float, radius_m: float = BOWL_RADIUS_M) -> Thing:
    """A fixed bowl on the counter; the radius is its floor's, m."""
    made = bowl(radius_m, BOWL_HEIGHT_M)
    return Thing(name, made.parts, 0.5, at(x, y, TOP_M), fixed=True, interior=made.interior)


def filled(
    name: str,
    container: Thing,
    count: int,
    radius_m: float,
    grain_kg: float,
    colour: Colour,
    sizes: tuple[float, ...] = (1.0,),
) -> Grains:
    """Grains that fill a container."""
    places = packed(container.room, container.pose, count, radius_m)
    return Grains(name, radius_m, grain_kg, places, colour, sizes)


def bearing_of(place: FloatArray) -> float:
    """Direction of a place from the base of the arm, rad."""
    return float(np.arctan2(place[1], place[0]))


def hand(place: FloatArray, bearing_rad: float, tilt_rad: float = 0.0) -> Pose:
    """A pose of the hand, whose fingers close sideways, with their tips at ``place``, (3,), m.

    ``bearing_rad`` is its horizontal direction. Its load leans to the left by ``tilt_rad``, about that
    bearing.
    """
    out = np.array([np.cos(bearing_rad), np.sin(bearing_rad), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    right = np.array([out[1], -out[0], 0.0])
    cos, sin = np.cos(PITCH_RAD), np.sin(PITCH_RAD)
    upright = np.array([cos * up - sin * out, right, cos * out + sin * up]).T
    if tilt_rad == 0.0:
        return Pose(np.array(place), upright)
    return Pose(np.array(place), Rotation.from_rotvec(-tilt_rad * out).as_matrix() @ upright)


def pouring(bowl_at: FloatArray, tilt_rad: float, over_m: float) -> Pose:
    """A hand that tilts a cup so that its load falls into the middle of a bowl.

    ``bowl_at`` is the middle of the bowl's underside, (3,), m; the cup tilts to the left as seen from the
    base if ``tilt_rad`` is positive; ``over_m`` is the height of the fingertips over the bowl's rim.
    """
    bearing = bearing_of(bowl_at)
    left = np.array([-np.sin(bearing), np.cos(bearing), 0.0])
    # The cup's rim, over the fingers, goes to the side.
    beyond = CUP_HEIGHT_M - GRIP_M + CUP_RADIUS_M
    aside = -np.sign(tilt_rad) * beyond * np.sin(min(abs(tilt_rad), np.pi / 2)) * left
    return hand(bowl_at + aside + np.array([0.0, 0.0, BOWL_HEIGHT_M + over_m]), bearing, tilt_rad)
