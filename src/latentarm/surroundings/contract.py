"""The contract of a source that says where things are: a camera with tags, a detector elsewhere."""

import math
import threading
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import Pose

FARTHEST_M: Final = 10.0  # from the arm's base
LEAST_SD_M: Final = 1e-4  # a source that says that it errs less is taken to err so much
LEAST_SD_RAD: Final = 1e-3
MOST_HOLD_S: Final = 60.0  # the longest `Source.hold_s`
_SKEW: Final = 1e-3  # largest error of a rotation matrix


@final
@dataclass(frozen=True, eq=False)
class Sighting:
    """One detection of a thing by a source.

    Raises UserError where a figure is missing, not finite or out of range, or the matrix is not a rotation.
    """

    name: str  # of the thing, as the task and the model name it
    # of its own frame (see `latentarm.robots.scene.thing.Thing`) in the arm's base frame: position (3,), m,
    # and rotation (3, 3)
    pose: Pose
    time_s: float  # when the picture was taken, by ``time.monotonic()`` of this machine
    position_sd_m: float  # standard deviation of each coordinate of the position
    # standard deviation of the turn about each axis; ``math.pi`` where the source cannot tell the turn
    orientation_sd_rad: float

    def __post_init__(self) -> None:
        position, rotation = self.pose.position, self.pose.rotation
        if position.shape != (3,) or not np.abs(position).max() <= FARTHEST_M:
            raise UserError(
                f"The position of {self.name!r} must be three numbers within {FARTHEST_M:g} m of the base."
            )
        if rotation.shape != (3, 3) or not np.abs(rotation @ rotation.T - np.eye(3)).max() <= _SKEW:
            raise UserError(f"The orientation of {self.name!r} is no rotation.")
        if np.linalg.det(rotation) < 0.0:
            raise UserError(f"The orientation of {self.name!r} is a mirror image, not a rotation.")
        if not math.isfinite(self.time_s):
            raise UserError(f"The sighting of {self.name!r} has no time.")
        if not LEAST_SD_M <= self.position_sd_m <= FARTHEST_M:
            raise UserError(
                f"The standard deviation of the position of {self.name!r} must be from {LEAST_SD_M:g} to"
                f" {FARTHEST_M:g} m."
            )
        if not LEAST_SD_RAD <= self.orientation_sd_rad <= math.pi:
            raise UserError(
                f"The standard deviation of the orientation of {self.name!r} must be from {LEAST_SD_RAD:g} to"
                f" pi rad."
            )


class Source(ABC):
    """Says where things are. All sources run together in a process of their own, apart from the arm's loop.

    A source is made by a factory of `latentarm.surroundings.catalogue.SOURCES`, which opens what it needs and
    raises UserError where that fails.
    """

    hold_s: float
    """For how long a sighting counts when no newer one comes, s; at most `MOST_HOLD_S`."""

    @abstractmethod
    def read(self) -> Sequence[Sighting]:
        """The newest sighting of each thing that was seen since the last call; it never waits.

        It is called some 50 times a second. Slow work belongs into a thread of the source.
        """

    @abstractmethod
    def close(self) -> None:
        """Let go of what was opened; closing twice is harmless."""


@final
class Newest:
    """The newest sighting of each thing, from a source's own threads to its `Source.read`."""

    def __init__(self) -> None:
        self._seen: dict[str, Sighting] = {}
        self._lock = threading.Lock()

    def put(self, seen: Iterable[Sighting]) -> None:
        """Add sightings."""
        with self._lock:
            self._seen |= {one.name: one for one in seen}

    def take(self) -> tuple[Sighting, ...]:
        """Those since the last call."""
        with self._lock:
            seen, self._seen = self._seen, {}
        return tuple(seen.values())
