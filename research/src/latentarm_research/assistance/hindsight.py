"""Hindsight optimisation: the person's action plus the help that is expected to lower their cost the most.

Javdani, Admoni, Pellegrinelli, Srinivasa and Bagnell, "Shared autonomy via hindsight optimization for
teleoperation and teaming", 2018.
"""

import math
from typing import final

from latentarm.assistance.assistance import Assistance, Contribution
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm_research.assistance.expected_help import ExpectedHelp
from latentarm_research.assistance.goal_poses import PosesOf, that_pose


@final
class HindsightOptimisation(Assistance):
    """``a = a_h + Σ_g b(g) a_g``: help is added to whatever the person does, and goes on when they let go.

    Made for the belief of `HindsightBelief`.

    Args:
        goals: (G, n), rad.
        robot: the arm.
        poses_of: at which poses a goal is reached.

    Raises:
        UserError: a goal has too many poses.
    """

    def __init__(self, goals: FloatArray, robot: Robot, poses_of: PosesOf = that_pose) -> None:
        self._expected = ExpectedHelp(goals, robot, poses_of)

    @property
    def acts_at_rest(self) -> bool:
        """Yes."""
        return True

    def contribution(
        self, u: FloatArray, action_human: FloatArray, state: FloatArray, belief: FloatArray
    ) -> Contribution:
        """All of the help is added."""
        return Contribution(self._expected.action(action_human, state, belief), alpha=0.0, added=1.0)

    def bound_rad(self, given: Contribution, state: FloatArray, belief: FloatArray, sigma_h: float) -> float:
        """None is known: equation 14 is about help that takes the place of the person's action."""
        return math.nan
