"""Retargeting: the stick's twist mimicked by the arm as well as its joints allow.

Rakita, Mutlu and Gleicher, "A motion retargeting method for effective mimicry-based teleoperation of robot
arms", 2017, carry the motion of a person's hand over to an arm by an optimisation that trades the pose of the
hand for smooth, feasible joint motion. Of that, this keeps what applies to a stick of two axes.
"""

from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.axis_modes import PAIRS, AxisController
from latentarm.core.types import Context, FloatArray
from latentarm.robots.robot import Robot

# Weights of the objectives; all values are assumptions.
ROTATION_M: Final = 0.2  # a rad of wrong orientation: the tool's place matters more than its turn
EFFORT: Final = 1e-4  # of joint velocities, (m/rad)²: they stay small, and bounded at singular configurations
LIMITS: Final = 1.0  # of a velocity towards a joint's limit, (m/rad)², at the limit itself
NEAR_RAD: Final = 0.3  # where that begins, before the limit; it grows with the square of the nearness
WEIGHTS: Final = np.repeat([1.0, ROTATION_M], 3)


@final
class RetargetingController(AxisController):
    """The stick moves a target pose, and the arm follows it as well as its joints allow.

    The stick's offset is the target's twist: held for a moment, it carries the target on from where the
    tool is. The joint velocities v are those with the least::

        ‖W (J v - twist)‖² + effort ‖v‖² + Σ_i limits near_i² v_i²

    over joints i that a first solution without the last term moves towards a limit, where ``near_i`` grows
    from 0 to 1 over `NEAR_RAD` before the limit. W counts a radian as `ROTATION_M`.

    Kept of Rakita et al.: matching position and orientation as objectives rather than constraints, position
    before orientation; small joint velocities; keeping away from limits. Left out: the mapping of a human
    arm onto the robot's, which a stick has no use for; jerk, which the loop's filters limit; and collisions
    with the arm itself, which they prevent. Modes are those of end-effector control, because two axes
    cannot command six.
    """

    def __init__(
        self,
        robot: Robot,  # the arm; its first tool is driven
        linear_speed: float = 0.15,  # of a full input along an axis, m/s
        angular_speed: float = 0.5,  # of a full input about an axis, rad/s
    ) -> None:
        super().__init__(robot, linear_speed, angular_speed, PAIRS)
        self._limits = robot.limits

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Joint velocities that follow the target best, (..., n), rad/s."""
        state = context.state
        transforms = self._chain.link_transforms(state)
        pose = self._chain.tool_pose(transforms)
        jacobian = self._chain.jacobian_at(transforms, pose)
        twist = np.vecmat(z, self._modes.twists(mode, self._scale, pose.rotation))
        matched = WEIGHTS[:, None] * jacobian
        wanted = np.vecmat(WEIGHTS * twist, matched)
        normal = matched.mT @ matched + EFFORT * np.eye(state.shape[-1])
        first = np.linalg.solve(normal, wanted[..., None])[..., 0]
        held = LIMITS * np.where(first > 0.0, self._near_upper(state), self._near_lower(state)) ** 2
        return np.linalg.solve(normal + held[..., None] * np.eye(state.shape[-1]), wanted[..., None])[..., 0]

    def _near_upper(self, state: FloatArray) -> FloatArray:
        """From 0, `NEAR_RAD` and more before each joint's upper limit, to 1, at it, (..., n)."""
        return np.clip(1.0 - (self._limits.upper - state) / NEAR_RAD, 0.0, 1.0)

    def _near_lower(self, state: FloatArray) -> FloatArray:
        """The same before the lower limit."""
        return np.clip(1.0 - (state - self._limits.lower) / NEAR_RAD, 0.0, 1.0)
