"""The action that lowers the expected cost-to-go: what hindsight optimisation and its relatives share."""

import math
from copy import copy
from typing import Self, final

import numpy as np

from latentarm.assistance.assistance import Assistance, Contribution
from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.resolved_rates import Damping, joint_velocities
from latentarm.robots.robot import Robot
from latentarm_research.assistance.cost_to_go import LOOK_AHEAD_S
from latentarm_research.assistance.goal_poses import PosesOf, goal_poses, that_pose


class ExpectedHelp(Assistance):
    """``a_r = Σ_g b(g) a_g``: each goal's best twist (Javdani et al. 2018), by how likely the goal is.

    The twist is at most 0.06 m/s and 0.29 rad/s, below the gains of 0.2 m/s and 0.4 rad/s that the published
    system gave the person. Joint velocities follow by resolved rates.

    Raises:
        UserError: a goal has too many poses.
    """

    def __init__(self, goals: FloatArray, robot: Robot, poses_of: PosesOf = that_pose) -> None:
        self._robot, self._poses_of = robot, poses_of
        self._poses = goal_poses(goals, robot, poses_of)
        self._damping = Damping()

    @final
    def over(self, goals: FloatArray) -> Self:
        """See `Assistance.over`."""
        moved = copy(self)
        moved._poses = goal_poses(goals, self._robot, self._poses_of)
        return moved

    @final
    def bound_rad(self, given: Contribution, state: FloatArray, belief: FloatArray, sigma_h: float) -> float:
        """None is known: equation 14 is about help in proportion to the joints' distance."""
        return math.nan

    @final
    def twist(self, action_human: FloatArray, state: FloatArray, weights: FloatArray) -> FloatArray:
        """The expected twist, (6,), m/s and rad/s, in the base frame.

        Args:
            action_human: (n,), the person's action, rad/s.
            state: (n,), rad.
            weights: (G,), how much each goal counts; they sum to one.
        """
        reached = self._robot.chain.forward(np.stack([state, state + LOOK_AHEAD_S * action_human]))
        at, after = (Pose(reached.position[i], reached.rotation[i]) for i in range(2))
        return weights @ self._poses.twists(at, after)

    @final
    def action(self, action_human: FloatArray, state: FloatArray, weights: FloatArray) -> FloatArray:
        """The same as joint velocities, (n,), rad/s; see `twist`."""
        twist = self.twist(action_human, state, weights)
        return joint_velocities(twist[None], self._robot.chain.jacobian(state), self._damping)[0]
