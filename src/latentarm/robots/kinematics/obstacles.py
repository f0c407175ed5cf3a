"""Shapes that an arm must keep clear of, as plain data in the robot's base frame; names are for people."""

from dataclasses import dataclass

from latentarm.core.types import FloatArray


@dataclass(frozen=True)
class HalfSpace:
    """Everything behind a plane: a table top, a floor, a wall."""

    name: str
    point: FloatArray  # (3,), any point of the plane, m
    normal: FloatArray  # (3,), unit vector out of the solid


@dataclass(frozen=True)
class Sphere:
    """A solid ball about ``centre`` (3,), m."""

    name: str
    centre: FloatArray
    radius: float


@dataclass(frozen=True)
class Capsule:
    """A solid rod with round ends: all points within ``radius`` of a segment."""

    name: str
    start: FloatArray  # (3,), one end of the segment, m
    end: FloatArray  # (3,), the other end, m
    radius: float


@dataclass(frozen=True)
class Box:
    """A solid box."""

    name: str
    centre: FloatArray  # (3,), m
    rotation: FloatArray  # (3, 3), columns are the box's axes in the base frame
    half_extents: FloatArray  # (3,), half of the length along each of the box's axes, m


Obstacle = HalfSpace | Sphere | Capsule | Box
