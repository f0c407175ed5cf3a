"""Predict, then blend: no help until one goal stands out, then all of it.

Dragan and Srinivasa, "A policy-blending formalism for shared control", 2013, as Javdani et al. (2018) compare
with it.
"""

from typing import final

import numpy as np

from latentarm.assistance.assistance import Contribution
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm_research.assistance.expected_help import ExpectedHelp
from latentarm_research.assistance.goal_poses import PosesOf, that_pose


@final
class PolicyBlending(ExpectedHelp):
    """The person alone, until the likeliest goal is ahead of the next by enough; then help towards it alone.

    This is the baseline "blend" of Javdani et al.: their public implementation adds all of the help towards
    the likeliest goal once ``p1 - p2 > 0.4``, with the action and the belief of hindsight optimisation.
    Dragan and Srinivasa leave the arbitration open.

    Args:
        goals: (G, n), rad.
        robot: the arm.
        ahead: p1 - p2 above which the robot helps, in [0, 1].
        poses_of: at which poses a goal is reached.

    Raises:
        UserError: ``ahead`` is out of its range, or a goal has too many poses.
    """

    def __init__(
        self, goals: FloatArray, robot: Robot, ahead: float = 0.4, poses_of: PosesOf = that_pose
    ) -> None:
        if not 0.0 <= ahead <= 1.0:
            raise UserError(f"How far a goal must be ahead must be in [0, 1], not {ahead}.")
        super().__init__(goals, robot, poses_of)
        self._ahead = ahead

    @property
    def acts_at_rest(self) -> bool:
        """Once the robot is sure."""
        return True

    def contribution(
        self, u: FloatArray, action_human: FloatArray, state: FloatArray, belief: FloatArray
    ) -> Contribution:
        """Towards the likeliest goal, all of it or nothing."""
        likeliest = int(belief.argmax())
        others = np.delete(belief, likeliest)
        if belief[likeliest] - others.max(initial=0.0) <= self._ahead:
            return Contribution(np.zeros_like(action_human), alpha=0.0)
        only = np.zeros_like(belief)
        only[likeliest] = 1.0
        return Contribution(self.action(action_human, state, only), alpha=0.0, added=1.0)
