"""What a safety filter is, and what it knows."""

from abc import ABC, abstractmethod
from typing import final

import numpy as np

from latentarm.control.safety.body import Body, Placement
from latentarm.control.safety.bounds import Bounds
from latentarm.control.safety.proximity import Contacts, Proximity
from latentarm.control.safety.small import largest, smallest, some
from latentarm.types import FloatArray, Stop

_DRIFT_RAD = 0.05
"""A placement computed farther away than this is not reused."""


@final
class Surroundings:
    """One arm with its limits and everything it must keep clear of.

    Args:
        bounds: the limits.
        body: the arm.

    Attributes:
        bounds: as given.
        body: as given.
        proximity: its near pairs.
        reference: where the arm was placed last.
    """

    def __init__(self, bounds: Bounds, body: Body) -> None:
        self.bounds = bounds
        self.body = body
        self.proximity = Proximity(
            body, bounds.config.obstacles, bounds.config.link_speed, bounds.nearest_m, bounds.horizon_s
        )
        self.reference: Placement | None = None


@final
class Situation:
    """What the filters know at one tick; expensive quantities are computed once, on first use.

    Args:
        surroundings: the arm and what is about it.
        state: (n,), measured joint positions, rad, finite.
        velocity: (n,), the last command, rad/s.
        acceleration: (n,), the acceleration that the last command was reached with, rad/s².
        input_age_s: age of the newest input, s.

    Attributes:
        bounds: the limits.
        room: (2, n), distance to the lowest position (zero or below inside) and to the highest, rad.
        nearest_limit: the smallest of these distances in size, negative where a limit is passed, rad.
    """

    def __init__(
        self,
        surroundings: Surroundings,
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
        self.room = self.bounds.positions - state
        below, above = self.room
        self.nearest_limit = min(smallest(above), -largest(below))
        self._nearby: tuple[Placement, FloatArray] | None = None
        self._asked = velocity
        self._contacts: Contacts | None = None

    @property
    def placement(self) -> Placement:
        """The arm's points at the measured state."""
        reference = self.surroundings.reference
        if reference is None or some(reference.q != self.state):
            reference = self.surroundings.reference = Placement(self.surroundings.body, self.state)
        return reference

    def nearby(self) -> tuple[Placement, FloatArray]:
        """A placement of the arm that may be a few ticks old, for bounds that account for its age.

        Returns:
            The placement, and how far each joint has moved since, (n,), rad, zero or more.
        """
        reference = self.surroundings.reference
        if self._nearby is None or self._nearby[0] is not reference:
            drift = None if reference is None else np.abs(self.state - reference.q)
            if reference is None or drift is None or largest(drift) > _DRIFT_RAD:
                reference, drift = self.placement, np.zeros_like(self.state)
            self._nearby = reference, drift
        return self._nearby

    def contacts(self, speed: FloatArray) -> Contacts:
        """What the arm could come too close to if no joint is faster than this; may be a few ticks old.

        Args:
            speed: (n,), rad/s, zero or more.
        """
        if self._contacts is None or some(speed > self._asked):
            # Include what ordinary motion passes through next, so that this is computed once.
            self._asked = np.maximum(speed, np.abs(self.velocity)) + self.bounds.quickening
            self._contacts = self.surroundings.proximity.held(self.state, self._asked)
            if self._contacts is None:
                return self.contacts_now()
        return self._contacts

    def contacts_now(self) -> Contacts:
        """The same for the speed that was asked for last, measured at this very state."""
        if self._contacts is None or not self._contacts.fresh:
            self._contacts = self.surroundings.proximity.measured(self.placement, self._asked)
        return self._contacts


class SafetyFilter(ABC):
    """Makes a velocity safe in one respect, or rejects it."""

    @property
    @abstractmethod
    def name(self) -> str:
        """What the person is told when this filter has changed a command."""

    @abstractmethod
    def apply(self, velocity: FloatArray, situation: Situation) -> FloatArray | Stop:
        """The velocity as far as it is safe.

        Args:
            velocity: (n,), rad/s, what is wanted.
            situation: what is known at this tick.

        Returns:
            (n,), rad/s, ``velocity`` itself where nothing had to change; or why the arm must stop.
        """
