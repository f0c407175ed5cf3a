"""Published help that moves the tool: hindsight optimisation, HARMONIC's interpolation, policy blending.

All are made for `HindsightBelief`, and share the robot's action of Javdani, Admoni, Pellegrinelli, Srinivasa
and Bagnell, "Shared autonomy via hindsight optimization for teleoperation and teaming", 2018.
"""

import math
from collections.abc import Callable
from copy import copy
from functools import partial
from typing import Final, Literal, Self, cast, final

import numpy as np

from latentarm.assistance.assistance import Assistance, AssistanceRule, Contribution
from latentarm.assistance.belief import Rule
from latentarm.core.types import FloatArray
from latentarm.robots.kinematics.resolved_rates import Damping, joint_velocities
from latentarm.robots.robot import Robot
from latentarm_research.assistance.cost_to_go import LOOK_AHEAD_S, GoalPoses, HindsightBelief


class ExpectedHelp(Assistance):
    """``a_r = Σ_g b(g) a_g``: each goal's best twist, by how likely the goal is.

    The twist is at most 0.06 m/s and 0.29 rad/s, below the gains of 0.2 m/s and 0.4 rad/s that the published
    system gave the person. Joint velocities of the first tool follow by resolved rates.
    """

    def __init__(self, goals: FloatArray, robot: Robot) -> None:
        self._robot = robot
        self._poses = GoalPoses(robot.chain.forward(goals))
        self._damping = Damping()

    @final
    def over(self, goals: FloatArray) -> Self:
        """See `Assistance.over`."""
        moved = copy(self)
        moved._poses = GoalPoses(self._robot.chain.forward(goals))
        return moved

    @final
    def bound_rad(self, given: Contribution, state: FloatArray, belief: FloatArray, sigma_h: float) -> float:
        """None is known: equation 14 is about help in proportion to the joints' distance."""
        return math.nan

    @final
    def twist(self, action_human: FloatArray, state: FloatArray, weights: FloatArray) -> FloatArray:
        """The expected twist (6,), m/s and rad/s, in the base frame; ``weights`` (G,) sum to one."""
        return weights @ self._poses.twists(self._robot.chain.forward(state + LOOK_AHEAD_S * action_human))

    @final
    def action(self, action_human: FloatArray, state: FloatArray, weights: FloatArray) -> FloatArray:
        """The same as joint velocities, (n,), rad/s; see `twist`."""
        twist = self.twist(action_human, state, weights)
        return joint_velocities(twist[None], self._robot.chain.jacobian(state), self._damping)[0]


@final
class HindsightOptimisation(ExpectedHelp):
    """``a = a_h + Σ_g b(g) a_g``: help is added to whatever the person does, and goes on when they let go."""

    @property
    def acts_at_rest(self) -> bool:
        """Yes."""
        return True

    def contribution(
        self, u: FloatArray, action_human: FloatArray, state: FloatArray, belief: FloatArray
    ) -> Contribution:
        """All of the help is added."""
        return Contribution(self.action(action_human, state, belief), alpha=0.0, added=1.0)


@final
class Interpolation(ExpectedHelp):
    """``a = (1 - w) a_h + w Σ_g b(g) a_g``, HARMONIC's help.

    From Newman, Aronson, Srinivasa, Kitani and Admoni, "HARMONIC: A multimodal dataset of assistive
    human-robot collaboration", 2022. The robot's action and the belief are those of hindsight optimisation;
    only how they join the person's action differs. At weight 1 the person's input moves nothing, and still
    says which goal they want.
    """

    def __init__(self, goals: FloatArray, robot: Robot, weight: float) -> None:
        super().__init__(goals, robot)
        self._weight = weight

    @property
    def acts_at_rest(self) -> bool:
        """Wherever the robot has any weight."""
        return self._weight > 0.0

    def contribution(
        self, u: FloatArray, action_human: FloatArray, state: FloatArray, belief: FloatArray
    ) -> Contribution:
        """The robot's action, at its weight."""
        return Contribution(self.action(action_human, state, belief), alpha=self._weight)


AHEAD: Final = 0.4  # probability by which the likeliest goal must be ahead of the next


@final
class PolicyBlending(ExpectedHelp):
    """The person alone, until the likeliest goal is ahead of the next by enough; then help towards it alone.

    This is the baseline "blend" of Javdani et al.: their public implementation adds all of the help towards
    the likeliest goal once ``p1 - p2 > 0.4``. Dragan and Srinivasa, "A policy-blending formalism for shared
    control", 2013, leave the arbitration open.
    """

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
        if belief[likeliest] - others.max(initial=0.0) <= AHEAD:
            return Contribution(np.zeros_like(action_human), alpha=0.0)
        only = np.zeros_like(belief)
        only[likeliest] = 1.0
        return Contribution(self.action(action_human, state, only), alpha=0.0, added=1.0)


AssistanceName = Literal["hindsight", "low_assist", "high_assist", "full_assist", "policy_blending"]

_PUBLISHED: Final[dict[AssistanceName, Callable[..., Assistance]]] = {
    "hindsight": HindsightOptimisation,
    # Losey et al. say that High Assist gives assistance twice the weight; the others are read from that.
    "low_assist": partial(Interpolation, weight=1 / 3),
    "high_assist": partial(Interpolation, weight=2 / 3),
    "full_assist": partial(Interpolation, weight=1.0),
    "policy_blending": PolicyBlending,
}


def published_assistance(name: AssistanceName, robot: Robot) -> AssistanceRule:
    """A published kind of help by name. HARMONIC's No Assist is no assistance."""
    return partial(_PUBLISHED[name], robot=robot)


def published_belief(robot: Robot) -> Rule:
    """The belief that `published_assistance` was published with."""
    return cast(Rule, partial(HindsightBelief, robot=robot))
