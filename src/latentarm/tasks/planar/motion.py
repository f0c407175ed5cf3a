"""What the four tasks of section 8.1 have in common."""

from abc import ABC, abstractmethod

import numpy as np

from latentarm.robots.robot import Robot
from latentarm.types import Demonstrations, FloatArray

STEP_S = 0.01
"""dt of the transition ``s' = s + a dt``, s: one period of the 100 Hz control loop. The paper leaves it open;
it is short enough for a step along the tightest curve to turn by less than three degrees, so that figures
speak of the task's shape and not of the step's length."""

SAMPLES = 100
"""State-action pairs of a demonstration, spread evenly over its duration."""

BACK_AND_FORTH_S = 20.0
"""Duration of a demonstration that goes back and forth: long enough to pass most of its states both ways, so
that a state does not tell in which direction the person is about to go."""

POSTURE_SPREAD_RAD = 0.15
"""SD of a demonstration's first posture about the nominal one, rad: the arm has more joints than the task
needs, and nobody begins twice in the same posture."""

CURL_RAD = 0.95
"""Bend of every joint but the first in the nominal posture of one arm. So curled, its tool moves about as
readily to all sides (J J^T is near a multiple of 1), which is how a person would hold such an arm."""

BEARING_RAD = 0.75 * np.pi
"""Direction from the base to the tool in that posture; the tool then lies near (-0.22, 0.22) m."""


def outline(middle: FloatArray, depth_m: float, width_m: float) -> FloatArray:
    """The closed outline (5, 2) of a rectangle about a middle (2,), m: along x and along y."""
    corner = np.array([[-1, -1], [-1, 1], [1, 1], [1, -1], [-1, -1]])
    return middle + corner * (depth_m / 2, width_m / 2)


class PlanarMotion(ABC):
    """A continuous motion to be demonstrated and learned, without discrete goals.

    Attributes:
        robot: the arm, or the two arms.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    @property
    @abstractmethod
    def name(self) -> str:
        """Short name, in snake_case."""

    @property
    @abstractmethod
    def latent_dim(self) -> int:
        """Size d of the latent action that the paper gives the task."""

    @property
    @abstractmethod
    def guides(self) -> tuple[FloatArray, ...]:
        """Lines that show the task in a figure, each (K, 2) in the plane, m."""

    @abstractmethod
    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Demonstrations by a simulated person, each of `SAMPLES` states with the actions taken there.

        Args:
            episodes: how many.
            rng: source of all variation.

        Raises:
            UserError: fewer than one episode is asked for.
        """
