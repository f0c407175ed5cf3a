"""How far the parts of the arm are from the zones in which it must be slow."""

from typing import final

import numpy as np

from latentarm.control.safety.body import Body, Placement
from latentarm.control.safety.zones import Zone
from latentarm.kinematics.distances import box_separation, segment_distance
from latentarm.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.types import FloatArray, IntArray


@final
class ZoneDistances:
    """Distances of the arm's parts to zones, measured when they are asked for and bounded in between.

    The K + T parts are the arm's moving capsules and its tools. A distance that was measured at q' is at
    q at least ``d - Σ_j lever_j |q_j - q'_j|`` (see `Body`).

    Args:
        body: the arm.
        zones: Z zones.

    Attributes:
        limit: (Z,), the zones' speeds, m/s.
    """

    def __init__(self, body: Body, zones: tuple[Zone, ...]) -> None:
        count = body.count
        tools = np.arange(2 * count, len(body.link))
        self._start: IntArray = np.concatenate([np.arange(count), tools])
        self._end: IntArray = np.concatenate([np.arange(count, 2 * count), tools])
        self._radius: FloatArray = body.radius[self._start]
        self._lever: FloatArray = np.maximum(body.lever[self._start], body.lever[self._end])
        self.limit: FloatArray = np.array([zone.speed for zone in zones])
        self._zones = zones
        self._distance = np.full((len(self._start), len(zones)), -np.inf)
        self._at = np.zeros(body.robot.dof)

    def of_parts(self, figures: FloatArray) -> FloatArray:
        """The larger of the figures of a part's ends, (K + T,), from those of the body's points (P,)."""
        return np.maximum(figures[self._start], figures[self._end])

    def bounded(self, q: FloatArray) -> FloatArray:
        """Lower bounds of the distances, (K + T, Z), m, from what was measured last.

        Args:
            q: (n,), rad.
        """
        return self._distance - (self._lever @ np.abs(q - self._at))[:, None]

    def measured(self, placement: Placement) -> FloatArray:
        """The distances, (K + T, Z), m; zero or less where a part reaches into a zone.

        Args:
            placement: the arm.
        """
        start, end = placement.points[self._start], placement.points[self._end]
        self._distance = np.stack([self._to(zone, start, end) for zone in self._zones], axis=1)
        self._at = placement.q
        return self._distance

    def _to(self, zone: Zone, start: FloatArray, end: FloatArray) -> FloatArray:
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
                normal = box_separation(
                    start,
                    end,
                    np.broadcast_to(centre, (count, 3)),
                    np.broadcast_to(rotation, (count, 3, 3)),
                    np.broadcast_to(extents, (count, 3)),
                )
                # The box reaches this far along the line between the closest points.
                edge = normal @ centre + np.abs(normal @ rotation) @ extents
                near = np.minimum(np.vecdot(normal, start), np.vecdot(normal, end))
                return near - edge - self._radius
