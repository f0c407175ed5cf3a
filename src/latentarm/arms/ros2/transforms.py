"""Frames of ROS: the transforms of ``/tf`` and ``/tf_static``, and poses by them."""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray

TOPICS: Final = {"/tf": "tf2_msgs/msg/TFMessage", "/tf_static": "tf2_msgs/msg/TFMessage"}
MOST_FRAMES: Final = 2000
Frames = Mapping[str, tuple[str, FloatArray]]  # parent, and pose (4, 4) in it, m, by child


def transforms_in(message: Mapping[str, Any]) -> Frames:
    """The transforms of a message; raises KeyError, TypeError or ValueError where it has none."""
    return {
        frame_name(one["child_frame_id"]): (
            frame_name(one["header"]["frame_id"]),
            pose_of(one["transform"]["translation"], one["transform"]["rotation"]),
        )
        for one in message["transforms"]
    }


def frame_name(name: object) -> str:
    """A frame's name as tf2 has it, without the slash of tf."""
    return str(name).strip("/")


def placed(name: str, base: str, frames: Frames) -> FloatArray | None:
    """The pose (4, 4), m, of a frame in the base frame, or in the last one above it; None where unknown."""
    if name not in frames:
        return None
    pose, at = np.eye(4), name
    for _ in range(len(frames)):
        if at not in frames or at == base:
            break
        at, step = frames[at]
        pose = step @ pose
    return pose if base in ("", at) else None


def pose_of(position: Mapping[str, Any], orientation: Mapping[str, Any]) -> FloatArray:
    """The pose (4, 4), m, of a point and a quaternion of ROS."""
    figures = [float(position[axis]) for axis in "xyz"], [float(orientation[axis]) for axis in "xyzw"]
    frame = np.eye(4)
    frame[:3, 3] = figures[0]
    frame[:3, :3] = Rotation.from_quat(figures[1]).as_matrix()
    if not np.isfinite(frame).all():
        raise ValueError("a transform that is not finite")
    return frame
