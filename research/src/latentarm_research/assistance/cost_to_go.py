"""The cost-to-go of hindsight optimisation: what it takes to bring the tool to a goal.

Javdani, Admoni, Pellegrinelli, Srinivasa and Bagnell, "Shared autonomy via hindsight optimization for
teleoperation and teaming", 2018. The paper gives the form; the constants are those of its public
implementation.
"""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.rotations import rotation_vector

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
