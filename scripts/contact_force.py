"""How hard an arm presses on a table that its safety filters know, and on one that they do not.

A Panda in MuJoCo with 1 kg at its tool, noise on its readings, and readings that are 0 to 3 ticks late, is
pushed down at 100 Hz with full input, from places over the whole table. Most of the time the stick points
straight down; the rest of the time anywhere. The filters do not limit force. What ends the pushing on a table
that they do not know is the following error: the joints move less far than they are commanded to.

    python scripts/contact_force.py --drives 40
"""

import argparse
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from latentarm.arms.mujoco import MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.safety.config import SafetyConfig
from latentarm.control.step import Step
from latentarm.controllers.end_effector import EndEffectorController
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from latentarm.scene.scene import TABLE, TOOL, Scene
from latentarm.tasks.inverse_kinematics import solve
from latentarm.types import FloatArray, Input, Pose
from physics_safety import LATE_TICKS, PERIOD_S, imperfect

PUSH_TICKS: Final = 300

UP_AND_DOWN: Final = 1
"""The controller's mode whose first axis moves the tool up and down."""

BOTH: Final = (min(TOOL, TABLE), max(TOOL, TABLE))

AT_M: Final = ((0.35, 0.6), (-0.3, 0.3), (0.05, 0.12))
"""Where the tool starts, x, y and z, m."""


@dataclass
class Pressed:
    """What came of all drives with one delay at one table.

    Attributes:
        peak_n: the largest force of each drive that touched the table, N.
        touched_s: from the first touch until the arm was stopped or the drive ended, s, of the same drives.
        drives: how many there were.
        stops: drives in which the filters stopped the arm.
    """

    peak_n: list[float] = field(default_factory=list)
    touched_s: list[float] = field(default_factory=list)
    drives: int = 0
    stops: int = 0


def start(robot: Robot, rng: np.random.Generator) -> FloatArray:
    """A configuration with the tool over the table, pointing down, (n,), rad."""
    place = np.array([rng.uniform(*span) for span in AT_M])
    home = robot.chain.forward(robot.home)
    return solve(robot, Pose(place, home.rotation), robot.home)


def drive(robot: Robot, late: int, known: bool, pressed: Pressed, rng: np.random.Generator) -> None:
    """Push down once."""
    scene, controller, clock = Scene(), EndEffectorController(robot), SimulatedClock()
    imperfections = imperfect(late, rng)
    arm = MujocoArm(robot, start(robot, rng), clock.now_s, imperfections, scene)
    config = SafetyConfig(obstacles=(scene.table,) if known else ())
    step = Step(robot, controller, config, dt_s=PERIOD_S)
    arm.connect()
    step.reset(arm.read().q)
    step.choose_mode(UP_AND_DOWN)
    pressed.drives += 1
    peak_n, first_s, last_s = 0.0, None, 0.0
    for tick in range(late + 2 + PUSH_TICKS):
        clock.wait_until(PERIOD_S * (tick + 1))
        u = np.zeros(2)
        if tick == late + 2:
            arm.enable()
            if (refused := step.enable()) is not None:
                raise RuntimeError(f"the arm could not be enabled: {refused.reason}")
        if tick >= late + 2:
            u = np.array([-1.0, 0.0]) if rng.uniform() < 0.8 else rng.uniform(-1.0, 1.0, 2)
        record = step(Input(u), 0.0, arm.read(), clock.now_s())
        arm.send(record.command)
        force_n = arm.scene_state().force_n.get(BOTH, 0.0)
        if force_n > 0.0 and first_s is None:
            first_s = clock.now_s()
        peak_n, last_s = max(peak_n, force_n), clock.now_s()
        if tick >= late + 2 and record.command.stop is not None:
            pressed.stops += 1
            break
    if first_s is not None:
        pressed.peak_n.append(peak_n)
        pressed.touched_s.append(last_s - first_s)


def main() -> None:
    """Drive, and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--drives", type=int, default=40, help="with each delay at each table")
    parser.add_argument("--seed", type=int, default=0)
    config = parser.parse_args()
    robot = panda()
    cells = [(known, late) for known in (True, False) for late in LATE_TICKS]
    table = Table(
        "table", "ticks late", "drives", "touched", "stopped", "largest force (N)", "median (N)", "s"
    )
    for known, late in track(cells, "drives", console=Console(stderr=True)):
        pressed = Pressed()
        for number in range(config.drives):
            # The same starts and inputs at both tables.
            drive(robot, late, known, pressed, np.random.default_rng([config.seed, late, number]))
        found = bool(pressed.peak_n)
        table.add_row(
            "known" if known else "not known",
            *(str(count) for count in (late, pressed.drives, len(pressed.peak_n), pressed.stops)),
            f"{max(pressed.peak_n):.0f}" if found else "0",
            f"{np.median(pressed.peak_n):.0f}" if found else "0",
            f"{np.median(pressed.touched_s):.2f}" if found else "–",
        )
    Console(width=150).print(table, "s: median time from the first touch to the stop")


if __name__ == "__main__":
    main()
