"""The contract of a source that says where things are: a camera with tags, a detector elsewhere."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
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

    Attributes:
        name: of the thing, as the task and the model name it.
        pose: of its own frame (see `latentarm.robots.scene.thing.Thing`) in the arm's base frame: position
            (3,), m, and rotation (3, 3).
        time_s: when the picture was taken, by ``time.monotonic()`` of this machine, s.
        position_sd_m: standard deviation of each coordinate of the position, m.
        orientation_sd_rad: standard deviation of the turn about each axis, rad; ``math.pi`` where the source
            cannot tell how the thing is turned.

    Raises:
        UserError: a figure is missing, not finite, or out of range; the rotation is none.
    """

    name: str
    pose: Pose
    time_s: float
    position_sd_m: float
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

    @property
    @abstractmethod
    def hold_s(self) -> float:
        """For how long a sighting counts when no newer one comes, s; at most `MOST_HOLD_S`."""

    @abstractmethod
    def read(self) -> Sequence[Sighting]:
        """The newest sighting of each thing that was seen since the last call; it never waits.

        It is called some 50 times a second. Slow work belongs into a thread of the source.
        """

    @abstractmethod
    def close(self) -> None:
        """Let go of what was opened; closing twice is harmless."""
