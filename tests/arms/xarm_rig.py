"""What tests of xArms share: a robot, and ways to wait for a driver."""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from latentarm.arms.real import RealArm
from latentarm.core.types import Command, FloatArray
from latentarm.robots.catalogue import load_robot
from latentarm.robots.gripper import Gripper
from latentarm.robots.limits_file import read_limits
from latentarm.robots.robot import Robot

HERE = Path(__file__).parent


@cache
def xarm7(*, gripper: bool = True) -> Robot:
    """An xArm 7 with stated limits, with the manufacturer's gripper or without."""
    robot = load_robot(HERE / "xarm7.xml", limits=read_limits(HERE / "xarm7.toml"))
    return replace(robot, gripper=Gripper((), 0.085, 0.1, 30.0)) if gripper else robot


def wait_for(what: Callable[[], bool], within_s: float = 5.0) -> None:
    """Until something is so."""
    end_s = time.monotonic() + within_s
    while not what():
        assert time.monotonic() < end_s, "it never came to that"
        time.sleep(0.005)


def enable(arm: RealArm) -> None:
    """Enable, and wait until the arm takes commands."""
    arm.enable()
    wait_for(lambda: arm.status().takes_commands)


def drive(arm: RealArm, velocity: FloatArray, for_s: float) -> None:
    """Send commands at 100 Hz."""
    until_s = time.monotonic() + for_s
    while time.monotonic() < until_s:
        arm.send(Command(velocity, duration_s=0.05))
        time.sleep(0.01)


def slow(robot: Robot) -> FloatArray:
    """(n,), rad/s."""
    return np.full(robot.dof, 0.1)
