"""Mode-switched control of the end-effector by resolved rates."""

from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.axis_modes import PAIRS, AxisController, AxisModes
from latentarm.core.types import Context, FloatArray
from latentarm.models.enclosure import linear_enclosure
from latentarm.robots.kinematics.resolved_rates import Damping, joint_velocities
from latentarm.robots.robot import Robot

KEPT_PLACE: Final = 10.0  # weight of a translation that was not asked for, beside the asked motion
KEPT_TURN: Final = 3.0  # the same of a turn
LOOSE_TURN: Final = 0.1  # the same during translations of an arm with too few joints to keep its turns
HOMEWARD_PER_S: Final = 2.0  # spare joints go home at this rate for a full input,
HOMEWARD_RAD_S: Final = 0.3  # and at most so fast

_UNFELT: Final = 1e-9  # a joint that moves the tool by no more than this per rad does not move it, m or rad
_POSES: Final = 8  # configurations at which an arm's joints are counted against the tool's motions


@final
class EndEffectorController(AxisController):
    """Mode-switched control of the tool.

    Translations are along the axes of the base frame. Turns are about the axes of the tool frame
    through the tool point: roll about its x, pitch about its y, yaw about its z, the way it points.
    Joint velocities follow by resolved rates: of all that give the wanted twist, the smallest. Near singular
    configurations no joint velocities give it. There the asked motion becomes slower, and never turns round.
    Translations that were not asked for stay below 1/20 of a full input for each asked axis, and turns below
    1/6, but that an arm with too few joints turns its tool as it has to while it moves it.

    An arm with spare joints could end with its elbow anywhere, at joint limits or at singular configurations.
    So while the person pushes, these joints move towards home as far as the tool does not move by it (the
    gradient projection of Liégeois, 1977).

    Args:
        robot: the arm; its first tool is driven.
        linear_speed: of a full input along an axis, m/s.
        angular_speed: of a full input about an axis, rad/s.
        damping: behaviour near singular configurations, where a full input along an axis counts as one about
            an axis.
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
        asked = np.array([np.eye(6)[list(rows)] for rows in modes.axes])  # (modes, d, 6)
        # Row: the axis that the input drives. Column: the axis whose motion is weighted.
        weights = np.full((6, 6), KEPT_TURN)
        weights[:, :3] = KEPT_PLACE
        ways = _ways(robot)
        # An arm with fewer joints than its tool has ways to move turns its tool as it has to.
        if np.linalg.matrix_rank(np.concatenate(list(ways), axis=-1)) > robot.dof:
            weights[:3, 3:] = LOOSE_TURN
        self._weights = np.where(asked > 0.0, 1.0, asked @ weights) * (angular_speed / self._scale)
        self._asked = angular_speed * asked
        # (n,), the joints that go home: those that turn, and move the tool, of an arm with more than it needs
        moves = (np.abs(ways) > _UNFELT).any(axis=(0, 1))
        self._spare = moves & ~robot.chain.slide & (moves.sum() > len(self._scale))
        self._home = robot.home

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """Joint velocities that move the tool along the mode's axes, (..., n), rad/s."""
        columns, homeward = self._parts(context, mode)
        return np.vecmat(z, columns) + np.abs(z).max(axis=-1, keepdims=True) * homeward

    def speed_bound(self, context: Context, mode: int) -> float:
        """The largest length of the part that is linear in the input, and that of the way home."""
        columns, homeward = self._parts(context, mode)
        linear = linear_enclosure(columns, np.zeros(columns.shape[-1])).largest()
        return float(linear + np.linalg.norm(homeward))

    def _parts(self, context: Context, mode: int) -> tuple[FloatArray, FloatArray]:
        """For a full input along each axis (..., d, n), and towards home (..., n), rad/s."""
        transforms = self._chain.link_transforms(context.state)
        pose = self._chain.tool_pose(transforms)
        jacobian = self._chain.jacobian_at(transforms, pose)
        along = np.concatenate([jacobian[..., :3, :], pose.rotation.mT @ jacobian[..., 3:, :]], axis=-2)
        # One axis of the input at a time: what the others may do, this one must not.
        weighted = self._weights[mode][..., None] * along[..., None, :, :]
        columns = joint_velocities(self._asked[mode][:, None, :], weighted, self._damping)[..., 0, :]
        return columns, self._homeward(context.state, jacobian)

    def _homeward(self, state: FloatArray, jacobian: FloatArray) -> FloatArray:
        """Towards home, (..., n), rad/s, without moving the tool, whose Jacobian is (..., 6, n)."""
        if not self._spare.any():
            return np.zeros(len(self._spare))
        way = HOMEWARD_PER_S * np.where(self._spare, self._home - state, 0.0)[..., None]
        way *= HOMEWARD_RAD_S / np.maximum(np.linalg.norm(way, axis=-2, keepdims=True), HOMEWARD_RAD_S)
        moving = np.linalg.qr(jacobian.mT)[0]
        return (way - moving @ (moving.mT @ way))[..., 0]


def _ways(robot: Robot) -> FloatArray:
    """(8, 6, n), how joints move the tool at configurations about home."""
    nearby = robot.home + np.random.default_rng(0).normal(size=(_POSES, robot.dof))
    return robot.chain.jacobian(nearby)
