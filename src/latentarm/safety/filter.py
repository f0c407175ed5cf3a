"""The contract of a safety filter, its view of one tick, and the filters that keep a direction."""

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, final

import numpy as np
from typing_extensions import override

from latentarm.core.types import FloatArray, Stop
from latentarm.safety.body import Body, Placement
from latentarm.safety.proximity import Contacts, Proximity
from latentarm.safety.small import any_nonzero, largest, smallest
from latentarm.safety.zone_distances import ZoneDistances

if TYPE_CHECKING:
    from latentarm.safety.limits import Bounds

_DRIFT_RAD = 0.05  # a placement computed farther away than this is not reused


@final
class GuardedArm:
    """One arm with its limits, everything it must keep clear of, and where it was placed last."""

    def __init__(self, bounds: "Bounds", body: Body) -> None:
        self.bounds = bounds
        self.body = body
        self.proximity = Proximity(
            body,
            bounds.config.obstacles,
            bounds.config.link_speed,
            bounds.nearest_m,
            bounds.horizon_s,
            bounds.config.clearance,
        )
        self.zones = ZoneDistances(body, bounds.config.zones)
        self.reference: Placement | None = None


@final
class Situation:
    """One tick as the filters see it; expensive quantities are computed once, on first use.

    Of the arm: its finite measured joint positions (n,), rad; the last command (n,), rad/s, and the
    acceleration that it was reached with, rad/s².
    """

    def __init__(
        self,
        surroundings: GuardedArm,
        state: FloatArray,
        velocity: FloatArray,
        acceleration: FloatArray,
        input_age_s: float = 0.0,
    ) -> None:
        self.surroundings = surroundings
        self.bounds = surroundings.bounds
        self.state = state
        self.velocity = velocity
        self.acceleration = acceleration
        self.input_age_s = input_age_s
        # (2, n), distance to the lowest position (zero or below inside) and to the highest, rad
        self.room = self.bounds.positions - state
        below, above = self.room
        # The smallest of these distances in size, negative where a limit is passed, rad
        self.nearest_limit = min(smallest(above), -largest(below))
        self._nearby: tuple[Placement, FloatArray] | None = None
        self._asked = velocity
        self._contacts: Contacts | None = None
        self._zone_distances: tuple[FloatArray, FloatArray] | None = None

    @property
    def placement(self) -> Placement:
        """The arm's points at the measured state."""
        reference = self.surroundings.reference
        if reference is None or any_nonzero(reference.q != self.state):
            reference = self.surroundings.reference = Placement(self.surroundings.body, self.state)
        return reference

    def nearby(self) -> tuple[Placement, FloatArray]:
        """A placement that may be a few ticks old, and how far each joint has moved since, (n,), rad, ≥ 0."""
        reference = self.surroundings.reference
        if self._nearby is None or self._nearby[0] is not reference:
            drift = None if reference is None else np.abs(self.state - reference.q)
            if reference is None or drift is None or largest(drift) > _DRIFT_RAD:
                reference, drift = self.placement, np.zeros_like(self.state)
            self._nearby = reference, drift
        return self._nearby

    def contacts(self, speed: FloatArray) -> Contacts:
        """Pairs that could come too close if no joint is faster than (n,), rad/s; may be a few ticks old."""
        if self._contacts is None or any_nonzero(speed > self._asked):
            # Include what ordinary motion passes through next, so that this is computed once.
            self._asked = np.maximum(speed, np.abs(self.velocity)) + self.bounds.quickening
            self._contacts = self.surroundings.proximity.held(self.state, self._asked)
            if self._contacts is None:
                return self.contacts_now()
        return self._contacts

    def contacts_now(self) -> Contacts:
        """The same for the last speed asked for, measured at this very state."""
        if self._contacts is None or not self._contacts.fresh:
            self._contacts = self.surroundings.proximity.measured(self.placement, self._asked)
        return self._contacts

    def zone_distances(self) -> tuple[FloatArray, FloatArray]:
        """Bounds of the parts' distances from the zones, least and most, (Z, K + T), m."""
        if self._zone_distances is None:
            self._zone_distances = self.surroundings.zones.bounded(self.state)
        return self._zone_distances

    def zone_distances_now(self, zone: int) -> FloatArray:
        """Distances of the parts from one zone, (K + T,), m, measured at this very state."""
        self._zone_distances = None
        return self.surroundings.zones.measured(zone, self.placement)


class SafetyFilter(ABC):
    """Makes a velocity safe in one respect, or rejects it."""

    name: str  # the name that ``limited_by`` gets when this filter has changed a command

    @abstractmethod
    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray | Stop:
        """The velocity (n,), rad/s, as far as it is safe, or why the arm must stop.

        Where nothing has to change this is ``velocity`` itself.
        """


@final
class Finite(SafetyFilter):
    """Stops where a velocity is not a number, not finite, or not one for each joint."""

    name = "finite"

    @override
    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray | Stop:
        if velocity.shape != situation.state.shape:
            return Stop(
                f"The controller gave {velocity.shape} numbers for {len(situation.state)} joints.",
                code="controller_invalid",
            )
        if not all(map(math.isfinite, velocity.tolist())):
            return Stop(
                "The controller gave a velocity that is not a finite number.", code="controller_invalid"
            )
        return velocity


@final
class JointVelocity(SafetyFilter):
    """Slows the whole arm down until its fastest joint is within the limit; the direction is kept."""

    name = "joint velocity"

    @override
    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray:
        speed, limit = np.abs(velocity), situation.bounds.speed
        if largest(speed) <= situation.bounds.slowest:
            return velocity
        # Written so that nothing overflows, neither at 1e308 nor at zero.
        share = smallest(limit / np.maximum(speed, limit))
        return velocity if share == 1.0 else velocity * share


HEADROOM = 0.95
"""Shaping aims for this share of the limit: the rest is for what turning links add before the next tick."""


@final
class LinkSpeed(SafetyFilter):
    """Slows the whole arm down until no point on any link, nor the tool, is too fast."""

    name = "link speed"

    @override
    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray:
        limit = HEADROOM * situation.bounds.config.link_speed
        nearby, drift = situation.nearby()
        bend = nearby.body.bent(drift) @ np.abs(velocity)
        if largest(nearby.speeds(velocity) + bend) <= limit:
            return velocity
        fastest = largest(situation.placement.speeds(velocity))
        return velocity if fastest <= limit else velocity * (limit / fastest)
