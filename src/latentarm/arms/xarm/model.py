"""The geometry of an xArm, as its controller knows it."""

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.arms.own_pose import OwnPose, poses_about
from latentarm.arms.real import FoundLimits
from latentarm.arms.xarm.controller import RefusedError
from latentarm.arms.xarm.sdk import Sdk
from latentarm.arms.xarm.session import Session
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot


def own_poses(session: Session, robot: Robot) -> tuple[OwnPose, ...]:
    """The tool where the arm stands, and at three other positions, which the controller computes.

    A firmware that computes none tells the first alone. Raises LinkLostError if the connection is lost.
    """
    status = session.status
    here, offset = _frame(status.tool), _frame(status.tool_offset)
    q = np.array(status.q[: robot.dof])
    try:
        # Whatever tool the controller reckons with, it is the same at all positions.
        to_tool = np.linalg.inv(_frame(session.controller.forward(q))) @ here
        elsewhere = [
            OwnPose(other, _frame(session.controller.forward(other)) @ to_tool, offset)
            for other in poses_about(q, robot)
        ]
    except RefusedError:
        elsewhere = []
    return (OwnPose(q, here, offset), *elsewhere)


def own_limits(sdk: Sdk, session: Session, robot: Robot) -> FoundLimits:
    """The positions that the manufacturer's library allows, infinite for an arm that it does not know.

    Speed and acceleration are the controller's, for all joints alike.
    """
    status = session.status
    known = sdk.joint_limits.get(status.axes, {}).get(status.kind, [])
    bounds = np.array(known if len(known) == robot.dof else [(-np.inf, np.inf)] * robot.dof)
    speed, acceleration = (
        np.full(robot.dof, one if one >= 0.0 else 0.0)  # what is no number allows nothing
        for one in (status.speed_rad_s, status.acceleration_rad_s2)
    )
    return FoundLimits(bounds[:, 0], bounds[:, 1], speed, acceleration)


def _frame(pose: FloatArray | tuple[float, ...]) -> FloatArray:
    """A pose in mm and roll, pitch, yaw, rad, as a transform (4, 4), m."""
    frame = np.eye(4)
    frame[:3, 3] = 1e-3 * np.asarray(pose[:3])
    frame[:3, :3] = Rotation.from_euler("xyz", pose[3:6]).as_matrix()
    return frame
