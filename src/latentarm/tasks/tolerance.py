"""When the tool counts as being where it should be; set before any result was seen."""

import numpy as np

from latentarm.kinematics.rotations import angle_between
from latentarm.types import Pose

REACHED_DISTANCE = 0.03
"""A waypoint is reached within this distance, m, ..."""

REACHED_ANGLE = np.deg2rad(20.0)
"""... and this angle, rad."""


def within(pose: Pose, waypoint: Pose) -> bool:
    """Whether one pose is within `REACHED_DISTANCE` and `REACHED_ANGLE` of another."""
    distance = np.linalg.norm(pose.position - waypoint.position)
    return bool(
        distance <= REACHED_DISTANCE and angle_between(pose.rotation, waypoint.rotation) <= REACHED_ANGLE
    )
