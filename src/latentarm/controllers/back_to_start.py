"""The way back to the start as a controller: it passes the same safety filters as a person's motion."""

from typing import Final, final

import numpy as np

from latentarm.control.controller import Controller
from latentarm.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.types import Context, FloatArray

JOINT_SPEED: Final = 0.35
"""Of the fastest joint, rad/s."""

TOOL_SPEED: Final = 0.15
"""Of the tool, m/s: as fast as a full push of the stick along a straight line."""

_SLOWING: Final = 3.0
"""Near the start, the speed of the farthest joint for each rad that it has still to go, 1/s."""


@final
class BackToStart(Controller):
    """One axis: a full input moves all joints straight towards the start, so that they arrive together.

    Args:
        robot: the arm; its first tool is kept slow.
        start: (n,), where the arm started, rad.

    Raises:
        UserError: the start is not n finite numbers.
    """

    def __init__(self, robot: Robot, start: FloatArray) -> None:
        goal = np.asarray(start, dtype=np.float64)
        if goal.shape != (robot.dof,) or not np.isfinite(goal).all():
            raise UserError(f"The start of this arm is {robot.dof} finite joint positions.")
        self._chain = robot.chain
        self._start = goal

    @property
    def modes(self) -> tuple[str, ...]:
        """One."""
        return ("back to start",)

    @property
    def input_dim(self) -> int:
        """One axis."""
        return 1

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """The input as it is."""
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Joint velocities (..., n) towards the start, rad/s; zero at the start."""
        away = self._start - context.state
        farthest = np.abs(away).max(axis=-1, keepdims=True)
        speed = np.minimum(JOINT_SPEED, _SLOWING * farthest)
        velocity = away * (speed / np.maximum(farthest, np.finfo(np.float64).tiny))
        transforms = self._chain.link_transforms(context.state)
        jacobian = self._chain.jacobian_at(transforms, self._chain.tool_pose(transforms))
        tool = np.linalg.norm((jacobian[..., :3, :] @ velocity[..., None])[..., 0], axis=-1, keepdims=True)
        return z[..., :1] * velocity / np.maximum(tool / TOOL_SPEED, 1.0)
