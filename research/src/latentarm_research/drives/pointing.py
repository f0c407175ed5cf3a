"""Movements of a simulated person along one axis, as in Fitts's law: to a target so far away and so wide."""

import math
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.arms.catalogue import PHYSICAL_ARM, make_simulated_arm
from latentarm.arms.contract import check_arm
from latentarm.assistance.controllers.contract import Controller
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import Input, Pose
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig
from latentarm_research.drives.drive import RATE_HZ
from latentarm_research.people.contract import LoopLimits
from latentarm_research.people.person import Person, SimulatedPerson

DWELL_S: Final = 0.3
"""A movement is over when the tool has come into the target and stays there for so long, s."""

GIVES_UP_S: Final = 15.0
"""A movement that takes longer has failed, s."""


@final
@dataclass(frozen=True)
class Pointing:
    """One movement along an axis of the base frame."""

    axis: int  # 0 to 2, for x, y and z
    distance_m: float  # from the start to the middle of the target, along the axis; negative is the other way
    width_m: float  # of the target

    @property
    def difficulty(self) -> float:
        """Index of difficulty, bits: Shannon's form, ``log2(D / W + 1)`` (MacKenzie 1992)."""
        return math.log2(abs(self.distance_m) / self.width_m + 1.0)


def point(
    robot: Robot, controller: Controller, person: Person, pointing: Pointing, rng: np.random.Generator
) -> float:
    """Move once from the arm's home, in physics, through Algorithm 1 and its filters.

    Returns the time until the tool came into the target to stay for `DWELL_S`, s; infinity where that took
    too long.
    """
    dt_s = 1.0 / RATE_HZ
    clock = SimulatedClock()
    step = Step(robot, controller, SafetyConfig(), dt_s=dt_s)
    operator = SimulatedPerson(robot, person, dt_s, LoopLimits(step.dead_zone, step.joint_speed))
    home = robot.chain.forward(robot.home)
    target = Pose(home.position + pointing.distance_m * np.eye(3)[pointing.axis], home.rotation)
    dwelt = 0
    with make_simulated_arm(PHYSICAL_ARM, robot, robot.home, clock.now_s) as arm:
        check_arm(arm.spec, robot)
        reading = arm.read()
        step.reset(reading.q)
        step(Input(np.zeros(controller.input_dim)), 0.0, reading, clock.now_s())
        arm.enable()
        step.enable()
        for tick in range(1, round(GIVES_UP_S * RATE_HZ) + 1):
            clock.wait_until(tick * dt_s)
            reading = arm.read()
            missed = (robot.chain.forward(reading.q).position - target.position)[pointing.axis]
            dwelt = dwelt + 1 if abs(missed) <= pointing.width_m / 2.0 else 0
            if dwelt >= round(DWELL_S * RATE_HZ):
                return (tick - dwelt + 1) * dt_s
            given = operator.act(
                step.context(reading.q), controller, step.mode, target, rng, pointing.width_m / 2.0
            )
            arm.send(step(given, 0.0, reading, clock.now_s()).command)
    return math.inf
