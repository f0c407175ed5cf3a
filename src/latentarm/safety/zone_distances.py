"""Distances of the arm's parts from the zones in which it must be slow."""

from typing import TYPE_CHECKING, final

import numpy as np

from latentarm.core.types import FloatArray, IntArray
from latentarm.robots.kinematics.distances import box_separation, segment_distance
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere

if TYPE_CHECKING:
    from latentarm.safety.body import Body, Placement
    from latentarm.safety.zones import Zone


@final
class ZoneDistances:
    """Distances of the arm's parts to zones, measured when they are asked for and bounded in between.

    The K + T parts are the arm's moving capsules and its tools. A distance that was measured at q' is at q
    within ``Σ_j lever_j |q_j - q'_j|`` of that (see `Body`).
    """

    def __init__(self, body: "Body", zones: "tuple[Zone, ...]") -> None:
        count = body.count
        tools = np.arange(2 * count, len(body.link))
        self.limit: FloatArray = np.array([[zone.speed] for zone in zones])  # (Z, 1), the zones' speeds, m/s
        self._start: IntArray = np.concatenate([np.arange(count), tools])
        self._end: IntArray = np.concatenate([np.arange(count, 2 * count), tools])
        self._radius: FloatArray = body.radius[self._start]
        self._lever: FloatArray = np.maximum(body.lever[self._start], body.lever[self._end]).T
        self._zones = zones
        self._distance = np.zeros((len(zones), len(self._start)))
        # What is not known: everything at first.
        self._doubt = np.full((len(zones), 1), np.inf)
        self._at = np.zeros((len(zones), body.robot.dof))
        self._measured: list[Placement | None] = [None] * len(zones)

    def of_parts(self, figures: FloatArray) -> FloatArray:
        """The larger of the figures of a part's ends, (K + T,), from those of the body's points (P,)."""
        return np.maximum(figures[self._start], figures[self._end])

    def bounded(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The least and the most, (Z, K + T), m, that each distance can be at q (n,), rad."""
        change = np.abs(q - self._at) @ self._lever + self._doubt
        return self._distance - change, self._distance + change

    def measured(self, zone: int, placement: "Placement") -> FloatArray:
        """The distances to a zone, (K + T,), m; zero or less where a part reaches into it."""
        if self._measured[zone] is not placement:
            start, end = placement.points[self._start], placement.points[self._end]
            self._distance[zone] = self._to(self._zones[zone], start, end)
            self._at[zone], self._doubt[zone] = placement.q, 0.0
            self._measured[zone] = placement
        return self._distance[zone]

    def _to(self, zone: "Zone", start: FloatArray, end: FloatArray) -> FloatArray:
        """Distances of the parts to one zone, (K + T,), m; lower bounds where they are above zero."""
        match zone.shape:
            case HalfSpace(point=point, normal=normal):
                return np.minimum((start - point) @ normal, (end - point) @ normal) - self._radius
            case Sphere(centre=centre, radius=radius):
                return segment_distance(start, end, centre, centre)[0] - radius - self._radius
            case Capsule(start=first, end=last, radius=radius):
                return segment_distance(start, end, first, last)[0] - radius - self._radius
            case Box(centre=centre, rotation=rotation, half_extents=extents):
                count = len(start)
                placed = np.broadcast_to(centre, (count, 3)), np.broadcast_to(rotation, (count, 3, 3))
                normal = box_separation(start, end, *placed, np.broadcast_to(extents, (count, 3)))
                # The box reaches this far along the line between the closest points.
                edge = normal @ centre + np.abs(normal @ rotation) @ extents
                near = np.minimum(np.vecdot(normal, start), np.vecdot(normal, end))
                return near - edge - self._radius
