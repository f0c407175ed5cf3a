"""At which poses a goal is reached: for help that moves the tool rather than the joints."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.robot import Robot
from latentarm_research.assistance.cost_to_go import MOST_POSES, GoalPoses

PosesOf = Callable[[Pose], Sequence[Pose]]
"""From the pose of the tool at a goal to all poses at which the goal is reached, 30 at most."""


def that_pose(pose: Pose) -> tuple[Pose, ...]:
    """Only that pose."""
    return (pose,)


def turned_about_vertical(count: int = MOST_POSES) -> PosesOf:
    """The same place, turned about the vertical by even parts of a whole turn: for things that are round."""
    return partial(_turned, count=count)


def _turned(pose: Pose, count: int) -> tuple[Pose, ...]:
    angles = np.arange(count) * (2.0 * np.pi / count)
    zero, one = np.zeros(count), np.ones(count)
    cos, sin = np.cos(angles), np.sin(angles)
    turns = np.array([[cos, -sin, zero], [sin, cos, zero], [zero, zero, one]]).transpose(2, 0, 1)
    return tuple(Pose(pose.position, turn @ pose.rotation) for turn in turns)


def goal_poses(goals: FloatArray, robot: Robot, poses_of: PosesOf) -> GoalPoses:
    """The poses of goals that are given as configurations.

    Raises:
        UserError: a goal has too many poses.
    """
    reached = robot.chain.forward(np.asarray(goals, dtype=np.float64))
    return GoalPoses([poses_of(Pose(*pose)) for pose in zip(reached.position, reached.rotation, strict=True)])
