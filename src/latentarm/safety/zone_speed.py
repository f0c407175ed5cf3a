"""Slows the arm down before it reaches into a zone, and keeps it slow there."""

from typing import final

import numpy as np
from typing_extensions import override

from latentarm.core.types import FloatArray
from latentarm.safety.filter import HEADROOM, SafetyFilter, Situation
from latentarm.safety.limits import Bounds
from latentarm.safety.small import any_nonzero, smallest
from latentarm.safety.zones import zone_filter_name

_NOTHING = 1e-300  # keeps a divisor from zero where a part stands still


@final
class ZoneSpeed(SafetyFilter):
    """Slows the whole arm down until each of its parts is slow enough for how far it is from one zone.

    A part (a capsule, or a tool) at the distance d from a zone with the limit L may have the speed

        L + k max(d - clearance - 1 mm - L T, 0)

    at the fastest point of its surface, with T the longest time that a command and its brake take, and k the
    share of its speed that ordinary motion can take off in a second (at most 1 / T). So an arm that comes at
    full speed is slow before it is there: it can follow this as it slows down, and the stop from such a speed
    ends before the zone. The direction is kept. An arm in a zone may move every way, and so out of it.

    This only makes the motion smooth. `Guard` proves the promise for each command.
    """

    def __init__(self, bounds: Bounds, index: int) -> None:
        zone = bounds.config.zones[index]
        self.name = zone_filter_name(zone.name)
        self._index = index
        self._limit = zone.speed
        self._gain_per_s = bounds.damping_per_s
        self._begins_m = bounds.nearest_m + zone.speed * bounds.reach_s
        # Farther away than this, the limit of all links holds and this one is not below it.
        self._far_m = self._begins_m + (bounds.config.link_speed - zone.speed) / self._gain_per_s

    @override
    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray:
        zones, bounds = situation.surroundings.zones, situation.bounds
        least, most = (distances[self._index] for distances in situation.zone_distances())
        if smallest(least) >= self._far_m:
            return velocity
        size = np.abs(velocity)
        nearby, drift = situation.nearby()
        bend = nearby.body.bent(bounds.reach_s * size + drift) @ size
        too_fast = zones.of_parts(nearby.speeds(velocity) + bend) > self._allowed(least)
        if not any_nonzero(too_fast):
            return velocity
        # Placement and distances were a few ticks old, which may be the only reason.
        placement = situation.placement
        if any_nonzero(most[too_fast] > self._begins_m):
            least = situation.zone_distances_now(self._index)
        allowed = self._allowed(least)
        speed = zones.of_parts(placement.speeds(velocity))
        bend = zones.of_parts(placement.body.bent(bounds.reach_s * size) @ size)
        # The largest share s with s speed + s² bend <= allowed; what links that turn add is the second.
        share = smallest(2.0 * allowed / (speed + np.sqrt(speed * speed + 4.0 * bend * allowed) + _NOTHING))
        return velocity if share >= 1.0 else share * velocity

    def _allowed(self, distance: FloatArray) -> FloatArray:
        """Speeds, m/s, for distances, m."""
        return HEADROOM * (self._limit + self._gain_per_s * np.maximum(distance - self._begins_m, 0.0))
