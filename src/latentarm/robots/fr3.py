"""The Franka Research 3 with the Franka Hand, from the manufacturer's published figures.

Its links are as long as the Panda's, and its shell is taken for the same. It can do other things:
https://frankarobotics.github.io/docs/robot_specifications.html
"""

from functools import cache
from typing import Final

import numpy as np

from latentarm.robots.limits import JointLimits, LimitSources
from latentarm.robots.panda import LIMITS as PANDA_LIMITS
from latentarm.robots.panda import franka
from latentarm.robots.robot import Robot

_LOWER: Final = np.array([-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159])
_UPPER: Final = np.array([2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159])

LIMITS: Final = JointLimits(
    lower=np.maximum(_LOWER, PANDA_LIMITS.lower),
    upper=np.minimum(_UPPER, PANDA_LIMITS.upper),
    velocity=np.array([2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26]),
    acceleration=np.full(7, 10.0),
    jerk=np.full(7, 5000.0),
    sources=LimitSources.same("manufacturer", 7),
)
"""The manufacturer's limits. Positions end where the Panda's do too: beyond, it is not known which of the
links cannot meet."""

TOOL_SPEED_LIMIT: Final = 3.0
"""Cartesian limit of the end-effector, m/s."""


@cache
def fr3() -> Robot:
    """The FR3 with its hand; "tool" is the point between the fingertips.

    Returns the same object each time; do not write to its arrays.
    """
    return franka("fr3", LIMITS, TOOL_SPEED_LIMIT)
