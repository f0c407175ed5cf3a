"""Planar arms as lines."""

from typing import TYPE_CHECKING, Final

import numpy as np

from latentarm.robots.robot import Robot
from latentarm.types import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ARM_COLOUR: Final = "#9aa3ad"
JOINT_COLOUR: Final = "#3c434b"


def arm_line(robot: Robot, state: FloatArray, tool: int = 0) -> FloatArray:
    """The joints of one arm from its base outwards and its tool, in the plane.

    Args:
        robot: one planar arm or two.
        state: (..., n), rad.
        tool: whose arm.

    Returns:
        (..., J + 1, 2), m.
    """
    chain = robot.chain
    transforms = chain.link_transforms(state)
    link = chain.tools[tool].link
    links = np.flatnonzero(chain.moves[link])
    joints = transforms[..., links, :2, 3]
    end = chain.tool_pose(transforms, tool).position[..., None, :2]
    return np.concatenate([joints, end], axis=-2)


def draw_arm(axes: "Axes", robot: Robot, state: FloatArray) -> None:
    """Draw all arms of a robot in one state (n,), with their joints and a mark on each base."""
    for tool in range(len(robot.chain.tools)):
        line = arm_line(robot, state, tool)
        axes.plot(*line.T, color=ARM_COLOUR, linewidth=2.4, solid_capstyle="round", zorder=3)
        axes.plot(*line[1:-1].T, "o", color="white", markeredgecolor=JOINT_COLOUR, markersize=2.6, zorder=3.1)
        axes.plot(*line[0], "s", color=JOINT_COLOUR, markersize=4.0, zorder=3.1)
        axes.plot(*line[-1], "o", color="black", markersize=3.0, zorder=6)


def draw_pose(axes: "Axes", robot: Robot, state: FloatArray, colour: str) -> None:
    """Draw all arms of a robot in one state (n,) as thin lines in one colour."""
    for tool in range(len(robot.chain.tools)):
        line = arm_line(robot, state, tool)
        axes.plot(*line.T, color=colour, linewidth=0.9, solid_capstyle="round", zorder=4)
        axes.plot(*line[-1], "o", color=colour, markersize=2.2, zorder=5)
