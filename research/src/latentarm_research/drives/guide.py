"""A simulated person who guides an arm by its tool (kinesthetic demonstrations), in physics."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.core.types import FloatArray, Pose
from latentarm.robots.kinematics.rotations import pose_error
from latentarm.robots.robot import Robot

_FOLLOW_PER_S: Final = 6.0
"""How fast the person corrects what separates the tool from where they mean it to be, 1/s."""

_POSTURE_PER_S: Final = 0.5
"""How fast the elbow is led back to the arm's usual posture where that does not move the tool, 1/s."""

_DAMPING: Final = 0.02
"""Of the inverse near singular configurations, m or rad per rad."""

_MARGIN_RAD: Final = 0.1
"""Kept from the joints' limits, rad."""

_PEAK: Final = 1.875
"""Highest speed of a movement of minimum jerk, compared with its mean."""


@final
@dataclass(frozen=True)
class GuidingHand:
    """How the simulated person moves the tool; all values are assumptions."""

    tool_speed: float = 0.2  # fastest that the tool moves, m/s
    turn_speed: float = 1.0  # fastest that it turns, rad/s
    joint_speed: float = 1.0  # fastest that any joint moves, rad/s
    slowest: float = 0.7  # a movement peaks at this share of those speeds, or more
    sway: float = 0.04  # SD of how far a movement leaves the straight line, as a share of its length
    miss_m: float = 0.002  # SD of where a movement ends, along each axis, m
    miss_rad: float = 0.02  # SD of how the tool is turned there, about each axis, rad
    pause_s: float = 0.3  # longest rest between movements, s


@final
class Movement:
    """One movement of the tool from a pose to another: of minimum jerk, a little off the straight line."""

    def __init__(
        self, start: Pose, end: Pose, hand: GuidingHand, speed: float, rng: np.random.Generator
    ) -> None:
        self._start = start
        self._way = pose_error(start, end) + rng.normal(0.0, np.repeat([hand.miss_m, hand.miss_rad], 3))
        length = float(np.linalg.norm(self._way[:3]))
        turn = float(np.linalg.norm(self._way[3:]))
        effort = speed * rng.uniform(hand.slowest, 1.0)
        self._duration_s = max(
            _PEAK * length / (hand.tool_speed * effort), _PEAK * turn / (hand.turn_speed * effort), 0.1
        )
        self._sway = rng.normal(0.0, hand.sway * length, 3)
        self._pause_s = rng.uniform(0.0, hand.pause_s)

    @property
    def duration_s(self) -> float:
        """How long it takes, with the rest after it, s."""
        return self._duration_s + self._pause_s

    def at(self, time_s: float) -> Pose:
        """Where the tool is meant to be."""
        share = min(max(time_s / self._duration_s, 0.0), 1.0)
        done = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        position = self._start.position + done * self._way[:3] + np.sin(np.pi * done) ** 2 * self._sway
        turn = Rotation.from_rotvec(done * self._way[3:]).as_matrix()
        return Pose(position, turn @ self._start.rotation)


def guided(
    robot: Robot, state: FloatArray, wanted: Pose, ahead: Pose, period_s: float, hand: GuidingHand
) -> FloatArray:
    """Joint velocities (n,), rad/s, with which the tool follows the person's hand.

    The tool is meant to be at ``wanted`` now and at ``ahead`` a period later. Resolved rates; what the tool
    leaves free leads the elbow back to the robot's home posture.
    """
    chain, limits = robot.chain, robot.limits
    transforms = chain.link_transforms(state)
    pose = chain.tool_pose(transforms)
    jacobian = chain.jacobian_at(transforms, pose)
    twist = pose_error(wanted, ahead) / period_s + _FOLLOW_PER_S * pose_error(pose, wanted)
    square = jacobian @ jacobian.T + _DAMPING**2 * np.eye(6)
    free = _POSTURE_PER_S * (robot.home - state)
    velocity = free + jacobian.T @ np.linalg.solve(square, twist - jacobian @ free)
    velocity /= max(1.0, float(np.abs(velocity).max()) / hand.joint_speed)
    lowest = (limits.lower + _MARGIN_RAD - state) / period_s
    highest = (limits.upper - _MARGIN_RAD - state) / period_s
    return np.clip(velocity, np.minimum(lowest, 0.0), np.maximum(highest, 0.0))
