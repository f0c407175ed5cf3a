"""What a safety filter is, and what it knows."""

from abc import ABC, abstractmethod
from functools import cached_property
from typing import final

import numpy as np

from latentarm.control.safety.body import Body, Placement
from latentarm.control.safety.bounds import Bounds
from latentarm.control.safety.proximity import Contacts, Proximity
from latentarm.types import FloatArray, Stop


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
    """

    def __init__(self, bounds: Bounds, body: Body) -> None:
        self.bounds = bounds
        self.body = body
        self.proximity = Proximity(body, bounds.config.obstacles, bounds.config.link_speed)


@final
class Situation:
    """What the filters know at one tick; what costs time is worked out once, when first asked for.

    Args:
        surroundings: the arm and what is about it.
        state: (n,), measured joint positions, rad, finite.
        velocity: (n,), the last command, rad/s.
        acceleration: (n,), the acceleration that the last command was reached with, rad/s².
        input_age_s: age of the newest input, s.
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
        self.state = state
        self.velocity = velocity
        self.acceleration = acceleration
        self.input_age_s = input_age_s
        self._asked: FloatArray | None = None
        self._contacts: Contacts | None = None

    @property
    def bounds(self) -> Bounds:
        """The limits."""
        return self.surroundings.bounds

    @cached_property
    def placement(self) -> Placement:
        """The arm's points at the measured state."""
        return Placement(self.surroundings.body, self.state)

    def contacts(self, speed: FloatArray) -> Contacts | None:
        """What the arm could come too near to when no joint is faster than this.

        Args:
            speed: (n,), rad/s, zero or more.
        """
        if self._asked is None or (speed > self._asked).any():
            bounds = self.bounds
            # Also what ordinary motion already passes through is asked for, so that this is worked out once.
            self._asked = np.maximum(speed, np.abs(self.velocity)) + bounds.acceleration * bounds.dt_s
            self._contacts = self.surroundings.proximity.contacts(
                self.placement, self.state, self._asked, bounds.nearest_m, bounds.horizon_s
            )
        return self._contacts


class SafetyFilter(ABC):
    """Makes a velocity safe in one respect, or refuses it."""

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
