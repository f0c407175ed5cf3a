"""Things that an arm can touch, hold, stab and cut."""

from dataclasses import dataclass
from typing import Literal, final

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Pose

Shape = Literal["box", "cylinder", "capsule", "sphere"]
UPRIGHT = (1.0, 0.0, 0.0, 0.0)  # the quaternion of a part that is not turned


@final
@dataclass(frozen=True)
class Part:
    """One convex solid of a thing."""

    shape: Shape
    # m: a box's three half lengths; radius and half length of a cylinder or capsule along z (of a capsule
    # without its caps); a sphere's radius
    size: tuple[float, ...]
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)  # its middle in the thing's frame, m
    quaternion: tuple[float, float, float, float] = UPRIGHT  # in the thing's frame, (w, x, y, z)
    # red, green, blue, opacity, each in [0, 1]
    colour: tuple[float, float, float, float] = (0.8, 0.8, 0.8, 1.0)


@final
@dataclass(frozen=True)
class Interior:
    """The room inside a container: an upright cylinder in its frame."""

    radius_m: float
    bottom_m: float  # lowest height in the thing's frame
    top_m: float  # height of the rim in the thing's frame


@final
@dataclass(frozen=True)
class Food:
    """The behaviour of food under a fork."""

    pierce_n: float  # force along the tines that makes them enter, N
    depth_m: float  # how deep the tines must enter for the food to stay on them, m
    grip_n: float  # pull that takes it off the tines again, N


@final
@dataclass(frozen=True, eq=False)
class Thing:
    """A rigid thing."""

    name: str  # unique in its scene
    parts: tuple[Part, ...]  # its solids
    mass_kg: float  # ignored where it is fixed
    pose: Pose  # of its frame when the scene begins, in the arm's base frame
    friction: float = 0.6  # sliding friction of its surface
    fixed: bool = False  # whether nothing can push it
    food: Food | None = None  # its behaviour under a fork; None where tines do not enter it
    interior: Interior | None = None  # room in a container, else None
    soft: tuple[Part, ...] = ()  # solids that are visible and give way to everything, such as icing

    @property
    def room(self) -> Interior:
        """The room in it; only a container has one."""
        if self.interior is None:
            raise UserError(f"{self.name!r} is no container: nothing can be in it.")
        return self.interior


@final
@dataclass(frozen=True)
class Bond:
    """Two things that are one until a cut parts them, such as slices of tofu."""

    first: str  # the cut lies in this thing's frame
    second: str  # the other thing
    point: tuple[float, float, float]  # any point of the plane of the cut, m
    normal: tuple[float, float, float]  # unit normal of that plane, from ``first`` to ``second``
    depth_m: float  # how far an edge must come through the plane, downwards from the top, m
    angle_rad: float  # largest turn of the edge out of the plane, rad


@final
@dataclass(frozen=True, eq=False)
class Grains:
    """Round grains: flour, eggs, coffee, rice."""

    name: str  # unique in its scene
    radius_m: float  # of the largest grains, m
    mass_kg: float  # of a grain, kg
    positions: FloatArray  # (K, 3), their middles when the scene begins, in the arm's base frame, m
    # Red, green, blue, opacity, each in [0, 1]
    colour: tuple[float, float, float, float] = (0.9, 0.85, 0.7, 1.0)
    # Radii of the grains as shares of the largest, in turn. Equal grains stand like a crystal and then leave
    # a cup all at once.
    sizes: tuple[float, ...] = (1.0,)
