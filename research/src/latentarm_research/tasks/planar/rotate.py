"""Rotate: two arms hold a box and turn it about a fixed point (1-D latent action).

The fixed point is the middle of the box, and the box lies elsewhere in every demonstration: so each state
has its own fixed point, and the state tells which. Both grippers are rigid on the box (place and heading:
three constraints for each arm of 5 joints); the grippers lead away from the bases, along the box's sides.
The nominal posture is one from which a turn of the box asks for about the same joint speed everywhere.
"""

from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.planar import planar
from latentarm.robots.robot import Robot
from latentarm_research.tasks.planar.motion import DEMONSTRATION_S, PlanarMotion
from latentarm_research.tasks.planar.paths import Paced, Path
from latentarm_research.tasks.planar.resolved_rate import Constraint

BOX_WIDTH_M: Final = 0.2
PLACE_M: Final = (0.62, 0.0)
PLACE_SPREAD_M: Final = 0.05
"""How far the middle of the box lies from its nominal place at most, along x and along y."""
LARGEST_TURN_RAD: Final = 0.5
SPEED_RAD_S: Final = 1.2
"""SD of the joint speed."""
LEFT_POSTURE_RAD: Final = (-0.67, -0.62, 0.73, 0.82, -0.27)
"""Nominal posture of the left arm; the right arm's is its mirror image."""

_PLANE: Final = (0, 1, 5)
"""Rows of a Jacobian that act in the plane: x, y and heading."""


@final
class Rotate(PlanarMotion):
    """Turn a box that both arms hold."""

    name = "rotate"
    words = "turn the box"
    latent_dim = 1  # the turn
    # the first two joints of each arm, and the last, which turns the gripper along the box
    closing = (0, 1, 4, 5, 6, 9)

    def __init__(self) -> None:
        super().__init__(planar(5, arms=2))

    @property
    def nominal(self) -> FloatArray:
        """See `PlanarMotion`."""
        return np.array([*LEFT_POSTURE_RAD, *(-joint for joint in LEFT_POSTURE_RAD)])

    @property
    def constraint(self) -> Constraint:
        """Place and heading of both grippers."""
        return _Grippers(self.robot)

    def paths(self, count: int, rng: np.random.Generator) -> Path:
        """Turns of the box about its middle, back and forth, somewhere near its nominal place."""
        middle = np.array(PLACE_M) + rng.uniform(-PLACE_SPREAD_M, PLACE_SPREAD_M, (count, 2))
        begin = rng.uniform(-LARGEST_TURN_RAD, LARGEST_TURN_RAD, count)
        ends = (-LARGEST_TURN_RAD, LARGEST_TURN_RAD)
        return Paced(lambda turn: _grips(middle, turn), begin, ends, SPEED_RAD_S, DEMONSTRATION_S, rng)


@final
class _Grippers(Constraint):
    """Place and heading of both grippers: (..., 6), m and rad."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def coordinates(self, state: FloatArray) -> FloatArray:
        """See `Constraint`."""
        poses = [self._robot.chain.forward(state, arm) for arm in (0, 1)]
        return np.concatenate(
            [part for pose in poses for part in (pose.position[..., :2], _head(pose)[..., None])], axis=-1
        )

    def jacobian(self, state: FloatArray) -> FloatArray:
        """See `Constraint`."""
        return np.concatenate(
            [self._robot.chain.jacobian(state, arm)[..., _PLANE, :] for arm in (0, 1)], axis=-2
        )


def _grips(middle: FloatArray, turn: FloatArray) -> FloatArray:
    """Where the grippers of boxes at middles (E, 2) turned by (E,) must be: (E, 6), m and rad."""
    side = BOX_WIDTH_M / 2 * np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
    return np.concatenate([middle + side, turn[:, None], middle - side, turn[:, None]], axis=-1)


def _head(pose: Pose) -> FloatArray:
    """Heading (...,) of a gripper, rad."""
    return np.arctan2(pose.rotation[..., 1, 0], pose.rotation[..., 0, 0])
