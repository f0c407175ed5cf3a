"""Mode-switched control of the end-effector by resolved rates."""

from typing import final

import numpy as np

from latentarm.assistance.controllers.axis_modes import PAIRS, AxisController, AxisModes
from latentarm.core.types import Context, FloatArray
from latentarm.models.enclosure import linear_enclosure
from latentarm.robots.kinematics.resolved_rates import Damping, joint_velocities
from latentarm.robots.robot import Robot


@final
class EndEffectorController(AxisController):
    """Mode-switched control of the tool.

    Translations are along the axes of the base frame. Turns are about the axes of the tool frame
    through the tool point: roll about its x, pitch about its y, yaw about its z, the way it points.
    Joint velocities follow by resolved rates: of all that give the wanted twist, the smallest.

    Args:
        robot: the arm; its first tool is driven.
        linear_speed: of a full input along an axis, m/s.
        angular_speed: of a full input about an axis, rad/s.
        damping: behaviour near singular configurations.
        modes: which axes the inputs drive in each mode.

    Raises:
        UserError: a speed is not positive and finite.
    """

    def __init__(
        self,
        robot: Robot,
        linear_speed: float = 0.15,
        angular_speed: float = 0.5,
        damping: Damping | None = None,
        modes: AxisModes = PAIRS,
    ) -> None:
        super().__init__(robot, linear_speed, angular_speed, modes)
        self._damping = damping or Damping()

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Joint velocities that move the tool along the mode's axes, (..., n), rad/s."""
        twists, jacobian = self._twists_and_jacobian(context.state, mode)
        return np.vecmat(z, joint_velocities(twists, jacobian, self._damping))

    def speed_bound(self, context: Context, mode: int) -> float:
        """Exact: the action is linear in the input."""
        columns = self.action(np.eye(self.input_dim), context, mode)
        return float(linear_enclosure(columns, np.zeros(columns.shape[-1])).largest())
