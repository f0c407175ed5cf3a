"""The arm of a control process: a simulated one is made anew for each start, a real one never."""

from dataclasses import replace

import numpy as np

from latentarm.arms.catalogue import make_arm, make_real_arm, make_scene_arm
from latentarm.arms.contract import Arm
from latentarm.arms.shadow import ShadowArm
from latentarm.control.clock import Clock
from latentarm.core.errors import UserError
from latentarm.robots.robot import Robot
from latentarm.web.arm_process.drive_setup import DriveSetup


def first_arm(setup: DriveSetup, clock: Clock) -> Arm:
    """Make and connect the arm of a setup. Raises UserError if it cannot be made or connected."""
    name, robot = setup.arm, setup.task.robot
    if setup.spec.shadow:
        arm = ShadowArm(make_real_arm(name, robot, clock.now_s))
    elif setup.real or setup.scene is None:
        arm = make_arm(name, robot, setup.start, clock.now_s)
    else:
        arm = make_scene_arm(name, robot, setup.start, clock.now_s, setup.scene)
    arm.connect()
    return arm


def from_where_it_stands(setup: DriveSetup, arm: Arm) -> DriveSetup:
    """The setup whose way back leads to where a real arm stands now; a simulated arm has its own start."""
    q = arm.read().q
    return replace(setup, start=np.array(q)) if setup.real and np.isfinite(q).all() else setup


def next_arm(setup: DriveSetup, before: DriveSetup, arm: Arm, clock: Clock) -> Arm:
    """The arm for the next setup: a simulated one is new, a real one stays.

    Raises UserError if the arm is real and connected as another robot, or a simulated one cannot be made.
    """
    if not setup.real:
        return first_arm(setup, clock)
    if not _alike(setup.task.robot, before.task.robot):
        raise UserError(
            f"{setup.spec.run or 'This'} is for the robot {setup.task.robot.name} with its limits and tool,"
            f" and the arm is connected as {before.task.robot.name} with others: end teleop and start it with"
            " that run."
        )
    return arm


def _alike(one: Robot, other: Robot) -> bool:
    here, there = one.limits, other.limits
    return (
        one.joint_names == other.joint_names
        and one.gripper == other.gripper
        and (one.tines is None) == (other.tines is None)
        and all(
            np.array_equal(getattr(here, figure), getattr(there, figure))
            for figure in ("lower", "upper", "velocity", "acceleration", "jerk")
        )
        and np.allclose(one.chain.forward(one.home).position, other.chain.forward(one.home).position)
    )
