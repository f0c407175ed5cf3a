"""A slow motion to a pose as a controller: it passes the same safety filters as a person's motion."""

from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.call_log import CallLog, logged
from latentarm.core.errors import UserError
from latentarm.core.types import Context, FloatArray
from latentarm.robots.robot import Robot

JOINT_SPEED: Final = 0.35  # of the fastest joint, rad/s
TOOL_SPEED: Final = 0.15  # of the tool, m/s: as fast as a full push of the stick along a straight line

_SLOWING: Final = 3.0
"""Near the pose, the speed of the farthest joint for each rad that it has still to go, 1/s."""


@final
class ToPose(Controller):
    """One axis: a full input moves all joints straight towards a pose, so that they arrive together.

    Raises:
        UserError: the pose is not n finite numbers.
    """

    def __init__(self, robot: Robot, pose: FloatArray) -> None:
        self._chain = robot.chain
        self._dof = robot.dof
        self.calls: CallLog | None = None
        self.lead_to(pose)

    @logged
    def lead_to(self, pose: FloatArray) -> None:
        """Lead to another pose (n,), rad, from now on; UserError where it is not n finite numbers."""
        goal = np.array(pose, dtype=np.float64)
        if goal.shape != (self._dof,) or not np.isfinite(goal).all():
            raise UserError(f"A pose of this arm is {self._dof} finite joint positions.")
        self._pose = goal

    @property
    def modes(self) -> tuple[str, ...]:
        return ("to a pose",)

    @property
    def input_dim(self) -> int:
        return 1

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Joint velocities (..., n) towards the pose, rad/s; zero there."""
        away = self._pose - context.state
        farthest = np.abs(away).max(axis=-1, keepdims=True)
        speed = np.minimum(JOINT_SPEED, _SLOWING * farthest)
        velocity = away * (speed / np.maximum(farthest, np.finfo(np.float64).tiny))
        transforms = self._chain.link_transforms(context.state)
        jacobian = self._chain.jacobian_at(transforms, self._chain.tool_pose(transforms))
        tool = np.linalg.norm((jacobian[..., :3, :] @ velocity[..., None])[..., 0], axis=-1, keepdims=True)
        return z[..., :1] * velocity / np.maximum(tool / TOOL_SPEED, 1.0)
