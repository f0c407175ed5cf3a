"""A person says where a thing is by bringing the tool to it."""

from math import atan2
from typing import Final, Literal

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, Pose
from latentarm.surroundings.contract import Sighting

TouchKind = Literal["place", "front", "undo"]
"""*place*: the thing's middle is below the tool. *front*: its x axis points to the tool. *undo*: forget the
newest of these."""

HOLD_S: Final = 600.0
"""A touch counts so long: a thing stays where it is unless somebody moves it."""

SD_M: Final = 0.008  # of each coordinate, after driving the tool over the middle of a thing by eye
FRONT_SD_RAD: Final = 0.15  # about the vertical, after touching its front too
LEAST_M: Final = 0.03  # a front nearer to the middle tells no direction
_UNKNOWN_SD_RAD: Final = 1.0


def placed(name: str, standing: Pose | None, tool: Pose, time_s: float) -> Sighting:
    """A thing whose middle is below the tool.

    ``standing`` has the height and the tilt with which it stands: its heading is unknown, and zero. Without
    it, the middle is where the tool is, and the thing is not turned.
    """
    if standing is None:
        return Sighting(name, Pose(tool.position, np.eye(3)), time_s, SD_M, _UNKNOWN_SD_RAD)
    place = np.array([*tool.position[:2], standing.position[2]])
    return Sighting(name, Pose(place, _headed(standing.rotation, 0.0)), time_s, SD_M, _UNKNOWN_SD_RAD)


def turned(name: str, pose: Pose, tool: Pose, time_s: float) -> Sighting | None:
    """A thing turned about the vertical: its x axis points to the tool. None where that is too near."""
    x, y = (tool.position - pose.position)[:2].tolist()
    if np.hypot(x, y) < LEAST_M:
        return None
    front = Pose(pose.position, _headed(pose.rotation, atan2(y, x)))
    return Sighting(name, front, time_s, SD_M, FRONT_SD_RAD)


def _headed(rotation: FloatArray, heading_rad: float) -> FloatArray:
    """A rotation turned about the vertical until its x axis has this heading."""
    now_rad = atan2(rotation[1, 0], rotation[0, 0])
    return Rotation.from_euler("z", heading_rad - now_rad).as_matrix() @ rotation
