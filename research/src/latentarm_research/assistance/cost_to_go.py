"""The cost-to-go of hindsight optimisation: what it takes to bring the tool to a goal.

Javdani, Admoni, Pellegrinelli, Srinivasa and Bagnell, "Shared autonomy via hindsight optimization for
teleoperation and teaming", 2018. The paper gives the form; the constants are those of its public
implementation.
"""

from dataclasses import dataclass
from typing import Final, Self, Unpack, final

import numpy as np

from latentarm.assistance.belief import Belief, BeliefOptions
from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.rotations import rotation_vector
from latentarm.robots.robot import Robot

LOOK_AHEAD_S: Final = 0.1
"""For how long an input is held where it is asked what it leaves to be done, s."""


@final
@dataclass(frozen=True)
class HuberCost:
    """What it costs to close a distance d to zero, and how fast the robot closes it.

    A second at the distance d costs ``rate(d)``, and the cost-to-go V is its integral over the way::

        rate(d) = weight (slope d / near + constant)    for d <= near
                  weight (slope + constant)             beyond
        V(d)    = weight (slope d² / (2 near) + constant d)                  for d <= near
                  weight ((slope + constant) d - slope near / 2)             beyond
    """

    slope: float  # of the linear part
    near: float  # distance up to which the cost is quadratic, m or rad
    constant: float  # added to the slope everywhere
    weight: float  # of the whole cost
    price: float  # what the robot's own motion costs it; its speed is the slope of V divided by this
    soft: float  # distance below which the robot slows down in proportion, m or rad

    def rate(self, distance: FloatArray) -> FloatArray:
        """Cost of a second at distances (...), which is also the slope of `value`."""
        return self.weight * (self.slope * np.minimum(distance / self.near, 1.0) + self.constant)

    def value(self, distance: FloatArray) -> FloatArray:
        """V, the cost-to-go from distances (...)."""
        # Both branches as one: quadratic up to near, then straight on at the slope that it has there.
        inside = np.minimum(distance, self.near)
        return self.weight * (
            self.slope * (inside * inside / (2.0 * self.near) + distance - inside) + self.constant * distance
        )

    def speed(self, distance: FloatArray) -> FloatArray:
        """How fast the robot closes distances (...), m/s or rad/s."""
        return self.rate(distance) * np.minimum(distance / self.soft, 1.0) / self.price


TRANSLATION: Final = HuberCost(slope=2.25, near=0.07, constant=0.2, weight=1.0, price=40.0, soft=0.02)
"""Of the tool's distance, m: 0.06 m/s from afar."""

ROTATION: Final = HuberCost(
    slope=0.20, near=np.pi / 32, constant=0.01, weight=0.07, price=0.05, soft=np.pi / 12
)
"""Of the tool's angle, rad: 0.29 rad/s from afar."""


@final
class GoalPoses:
    """The poses (G, ...) of the tool at the goals, and what it costs to get there."""

    def __init__(self, goals: Pose) -> None:
        self._goals = goals

    def advantage(self, at: Pose, after: Pose) -> FloatArray:
        """``Q_g - V_g``, (..., G), of inputs from tool poses (...) to others, held for `LOOK_AHEAD_S`.

        It is the cost of the way, and by how much the cost-to-go is higher at its end.
        """
        (shift_at, turn_at), (shift, turn) = _away(self._goals, at), _away(self._goals, after)
        far_at, turned_at = _length(shift_at), _length(turn_at)
        far, turned = _length(shift), _length(turn)
        cost = LOOK_AHEAD_S * (TRANSLATION.rate(far_at) + ROTATION.rate(turned_at))
        gain = TRANSLATION.value(far) + ROTATION.value(turned)
        return cost + gain - TRANSLATION.value(far_at) - ROTATION.value(turned_at)

    def twists(self, after: Pose) -> FloatArray:
        """The robot's best action towards each goal, (..., G, 6), m/s and rad/s, in the base frame.

        It goes down the slope of Q from where an input leads.
        """
        shift, turn = _away(self._goals, after)
        return np.concatenate([_towards(shift, TRANSLATION), _towards(turn, ROTATION)], axis=-1)


def _away(there: Pose, at: Pose) -> tuple[FloatArray, FloatArray]:
    """From tool poses (...) to goals' poses (G, ...), both (..., G, 3): a shift, m, and a turn, rad."""
    turn = there.rotation @ at.rotation[..., None, :, :].mT
    return there.position - at.position[..., None, :], rotation_vector(turn)


def _length(vector: FloatArray) -> FloatArray:
    return np.sqrt(np.vecdot(vector, vector))


def _towards(away: FloatArray, cost: HuberCost) -> FloatArray:
    """Velocities (..., 3) that close what is left (..., 3)."""
    distance = _length(away)
    # At the goal itself there is no direction, and no speed either.
    share = np.divide(cost.speed(distance), distance, out=np.zeros_like(distance), where=distance > 0.0)
    return share[..., None] * away


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
