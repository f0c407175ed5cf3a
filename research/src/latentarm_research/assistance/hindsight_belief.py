"""The belief of hindsight optimisation: Javdani et al., 2018, as their public implementation updates it."""

from typing import Final, Self, Unpack, final

from latentarm.assistance.belief import Belief, BeliefOptions
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm_research.assistance.cost_to_go import LOOK_AHEAD_S, GoalPoses

TICK_S: Final = 1.0 / 40.0
"""How often the published belief is updated, s."""

MOST_CERTAIN: Final = 0.99
"""Largest probability of a goal, as published; what is over is shared evenly among the others."""


@final
class HindsightBelief(Belief):
    """A person who lowers the cost-to-go of the tool: ``log b(g)`` falls by ``Q_g - V_g`` 40 times a second.

    ``V_g`` is the cost-to-go from where the tool is (`latentarm_research.assistance.cost_to_go`), ``Q_g``
    that of the person's own action: what it costs for 0.1 s, and the cost-to-go from where it leads. Inputs
    that the person did not choose are not considered. At another period than 1/40 s an update counts in
    proportion, so that the belief does not depend on the rate of the loop.

    One thing differs from the public implementation: an input of zero says nothing, as in every `Belief`.
    There the belief goes on changing at rest, in favour of the nearest goal.

    Args:
        goals: (G, n), the goals' configurations, rad.
        robot: the arm; only its first tool counts.
        options: see `Belief`; the period is 1/40 s, the floor 0 and the most 0.99 where they are not given.
    """

    def __init__(self, goals: FloatArray, robot: Robot, **options: Unpack[BeliefOptions]) -> None:
        published: BeliefOptions = {"period_s": TICK_S, "floor": 0.0, "most": MOST_CERTAIN}
        # The horizon of the base class is how long one full piece of evidence takes.
        super().__init__(goals, TICK_S, **(published | options))
        self._robot = robot
        self._poses = GoalPoses(robot.chain.forward(self.goals))

    def over(self, goals: FloatArray) -> Self:
        """See `Belief.over`."""
        moved = super().over(goals)
        moved._poses = GoalPoses(self._robot.chain.forward(moved.goals))
        return moved

    def log_likelihood(self, state: FloatArray, actions: FloatArray) -> FloatArray:
        """``V_g - Q_g`` of the person's own action; see `Belief.log_likelihood`."""
        at = self._robot.chain.forward(state)
        after = self._robot.chain.forward(state + LOOK_AHEAD_S * actions[..., 0, :])
        return -self._poses.advantage(at, after)
