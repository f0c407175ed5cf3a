"""Rotate: two arms hold a box and turn it about a fixed point (1-D latent action).

The fixed point is the middle of the box, and the box lies elsewhere in every demonstration: so each state
has its own fixed point, and the state tells which. Both grippers are rigid on the box (place and heading:
three constraints for each arm of 5 joints); the grippers lead away from the bases, along the box's sides.
The nominal posture is one from which a turn of the box asks for about the same joint speed everywhere.
"""

from typing import final

import numpy as np

from latentarm.robots.planar import planar
from latentarm.robots.robot import Robot
from latentarm.tasks.planar.motion import BACK_AND_FORTH_S, POSTURE_SPREAD_RAD, PlanarMotion, outline
from latentarm.tasks.planar.resolved_rate import follow
from latentarm.types import Demonstrations, FloatArray

BOX_WIDTH_M = 0.2
BOX_DEPTH_M = 0.12
PLACE_M = (0.62, 0.0)
PLACE_SPREAD_M = 0.05
"""How far the middle of the box lies from its nominal place at most, along x and along y."""
LARGEST_TURN_RAD = 0.8
SWING_RAD_S = (0.6, 1.2)
LEFT_POSTURE_RAD = (-0.67, -0.62, 0.73, 0.82, -0.27)
"""Nominal posture of the left arm; the right arm's is its mirror image."""

_PLANE = (0, 1, 5)
"""Rows of a Jacobian that act in the plane: x, y and heading."""


@final
class Rotate(PlanarMotion):
    """Turn a box that both arms hold."""

    def __init__(self) -> None:
        super().__init__(planar(5, arms=2))

    @property
    def name(self) -> str:
        """``rotate``."""
        return "rotate"

    @property
    def latent_dim(self) -> int:
        """1: the turn."""
        return 1

    @property
    def guides(self) -> tuple[FloatArray, ...]:
        """The box in its nominal place."""
        return (outline(np.array(PLACE_M), BOX_DEPTH_M, BOX_WIDTH_M),)

    def headings(self, state: FloatArray) -> FloatArray:
        """Headings (..., 2) of the left and the right gripper at states (..., 10), rad."""
        return _heads(self.robot, state)

    def demonstrate(self, episodes: int, rng: np.random.Generator) -> Demonstrations:
        """Turn the box back and forth about its middle, somewhere near its nominal place.

        Raises:
            UserError: fewer than one episode is asked for.
        """
        count = max(episodes, 0)
        middle = np.array(PLACE_M) + rng.uniform(-PLACE_SPREAD_M, PLACE_SPREAD_M, (count, 2))
        reach = rng.uniform(0.4, 1.0, count) * LARGEST_TURN_RAD
        mean = rng.uniform(-1.0, 1.0, count) * (LARGEST_TURN_RAD - reach)
        swing = rng.uniform(*SWING_RAD_S, count)
        phase = rng.uniform(0.0, 2 * np.pi, count)
        nominal = np.array([*LEFT_POSTURE_RAD, *(-joint for joint in LEFT_POSTURE_RAD)])
        start = nominal + rng.normal(0.0, POSTURE_SPREAD_RAD, (count, self.robot.dof))
        return follow(
            self.robot,
            start,
            lambda time: _grips(middle, mean + reach * np.sin(swing * time + phase)),
            lambda state: _held(self.robot, state),
            lambda state: np.concatenate(
                [self.robot.chain.jacobian(state, arm)[..., _PLANE, :] for arm in (0, 1)], axis=-2
            ),
            BACK_AND_FORTH_S,
            "turn the box",
        )


def _grips(middle: FloatArray, turn: FloatArray) -> FloatArray:
    """Where the grippers of boxes at middles (E, 2) turned by (E,) must be: (E, 6), m and rad."""
    side = BOX_WIDTH_M / 2 * np.stack([-np.sin(turn), np.cos(turn)], axis=-1)
    return np.concatenate([middle + side, turn[:, None], middle - side, turn[:, None]], axis=-1)


def _held(robot: Robot, state: FloatArray) -> FloatArray:
    """Place and heading of both grippers: (E, 6), m and rad."""
    places = [robot.chain.forward(state, arm).position[..., :2] for arm in (0, 1)]
    heads = _heads(robot, state)
    return np.concatenate([places[0], heads[..., :1], places[1], heads[..., 1:]], axis=-1)


def _heads(robot: Robot, state: FloatArray) -> FloatArray:
    turns = [robot.chain.forward(state, arm).rotation for arm in (0, 1)]
    return np.stack([np.arctan2(turn[..., 1, 0], turn[..., 0, 0]) for turn in turns], axis=-1)
