"""Inverse kinematics: configurations that put the tool at a given pose."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, Pose
from latentarm.robots.fixing import arm_model
from latentarm.robots.robot import Robot

_STEP_S = 0.1
STEPS: Final = 300  # at most, of some 0.1 ms each
_CLOSE = 1e-4  # tolerance of the pose, m and rad together
_POSTURE_COST = 1e-3  # weight of the preferred posture relative to the tool's pose; it resolves redundancy


def solve(
    robot: Robot, pose: Pose, posture: FloatArray, held: Sequence[int] = (), steps: int = STEPS
) -> FloatArray:
    """The configuration (n,), rad, near a posture that puts the robot's first tool at a pose.

    Differential inverse kinematics (mink), within the joint limits; the tool is a site of the model, and the
    pose in the base frame. The search starts at the posture (n,), rad; redundant joints stay close to it, and
    those with indices in ``held`` exactly there. Raises UserError where the arm is not there after ``steps``.
    """
    import mink

    model = arm_model(robot)
    wanted = np.eye(4)
    wanted[:3, :3], wanted[:3, 3] = pose.rotation, pose.position
    tool = mink.FrameTask(robot.chain.tools[0].name, "site", 1.0, 1.0, lm_damping=1e-6)
    tool.set_target(mink.SE3.from_matrix(wanted))
    near = mink.PostureTask(model, _POSTURE_COST)
    near.set_target(posture)
    limits = [mink.ConfigurationLimit(model)]
    constraints = [mink.DofFreezingTask(model, list(held))] if held else None
    configuration = mink.Configuration(model, posture)
    for _ in range(steps):
        if np.linalg.norm(tool.compute_error(configuration)) < _CLOSE:
            return np.array(configuration.q)
        try:
            velocity = mink.solve_ik(
                configuration, [tool, near], _STEP_S, "daqp", limits=limits, constraints=constraints
            )
        except mink.NoSolutionFound:
            break
        configuration.integrate_inplace(velocity, _STEP_S)
    place = ", ".join(f"{x:.2f}" for x in pose.position)
    raise UserError(
        f"The robot {robot.name} does not bring its tool to ({place}) m in the orientation asked for."
    )
