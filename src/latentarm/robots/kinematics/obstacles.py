"""Simple shapes that an arm must keep clear of, as plain data in the robot's base frame.

A task lists them, the safety filters turn them into distances; neither needs the other.
"""

from dataclasses import dataclass

from latentarm.core.types import FloatArray


@dataclass(frozen=True)
class HalfSpace:
    """Everything behind a plane: a table top, a floor, a wall.

    Attributes:
        name: what a person would call it.
        point: (3,), any point on the plane, m.
        normal: (3,), unit vector out of the solid, towards where the arm may be.
    """

    name: str
    point: FloatArray
    normal: FloatArray


@dataclass(frozen=True)
class Sphere:
    """A solid ball.

    Attributes:
        name: what a person would call it.
        centre: (3,), m.
        radius: m.
    """

    name: str
    centre: FloatArray
    radius: float


@dataclass(frozen=True)
class Capsule:
    """A solid rod with round ends: all points within ``radius`` of a segment.

    Attributes:
        name: what a person would call it.
        start: (3,), one end of the segment, m.
        end: (3,), the other end, m.
        radius: m.
    """

    name: str
    start: FloatArray
    end: FloatArray
    radius: float


@dataclass(frozen=True)
class Box:
    """A solid box, turned as ``rotation`` says.

    Attributes:
        name: what a person would call it.
        centre: (3,), m.
        rotation: (3, 3), columns are the box's axes in the base frame.
        half_extents: (3,), half of the length along each of the box's axes, m.
    """

    name: str
    centre: FloatArray
    rotation: FloatArray
    half_extents: FloatArray


Obstacle = HalfSpace | Sphere | Capsule | Box
