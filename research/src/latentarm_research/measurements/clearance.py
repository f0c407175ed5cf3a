"""Push arms towards harm, and let MuJoCo measure how near they come.

Each drive starts an arm in a random pose, with a table and a wall, box, ball or rod near it. A simulated
person pushes one point of the arm at the obstacle, or at another part of the arm, with full input, and
then stops. The filters keep their distance by capsules and distance code that `Judge` does not use.
"""

from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import numpy as np

from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import GripperReading, Input, Reading
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig
from latentarm_research.measurements.catalogue import Clearance
from latentarm_research.measurements.held_things import measure_held
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.pushing import HARMS, Pusher, scene

CLEARANCE_M: Final = SafetyConfig().clearance
ROUNDING_M: Final = 1e-5  # `mj_geomDistance` stops improving a distance between meshes at about a micrometre
PERIODS_S: Final = (0.001, 0.01, 0.02)
PUSH_S: Final = 2.0
LOOK_S: Final = 0.02
ARMS: Final = ("panda", "planar", "planar2", "ur5e", "jaco")


def measure(options: Clearance, work: Work) -> Outcome:
    """Drives, drives within twice the clearance, and the least distance of each arm."""
    numbers = range(options.drives)
    least_m = dict(zip(numbers, work.each(partial(numbered, work.seed), numbers), strict=True))
    rows, broken = [], list[str]()
    for index, name in enumerate(ARMS):
        mine = {number: one for number, one in least_m.items() if number % len(ARMS) == index}
        near = [number for number, one in mine.items() if one < CLEARANCE_M - ROUNDING_M]
        figures = {
            "within_40_mm_drives": sum(one < 2 * CLEARANCE_M for one in mine.values()),
            "least_distance_mm": 1000 * min(mine.values()) if mine else None,
            "too_near_drives": len(near),
        }
        rows += line("clearance", name, len(mine), figures)
        broken += [f"{name}, drive {number}: {1000 * mine[number]:.3f} mm" for number in near]
    with_things = measure_held(options.held_ticks, work)
    return Outcome([*rows, *with_things.rows], [*broken, *with_things.broken])


def numbered(seed: int, number: int) -> float:
    """The least distance of a drive by its number, m."""
    harm = HARMS[number // len(ARMS) % len(HARMS)]
    period_s = PERIODS_S[number // 25 % len(PERIODS_S)]
    return drive(arm(ARMS[number % len(ARMS)]), harm, period_s, np.random.default_rng([seed, number]))


@cache
def arm(name: str) -> Robot:
    """One of `ARMS`: three of ours, two from other people's packages."""
    match name:
        case "ur5e":
            return load_robot(_shipped("airo_models", "arms/ur5e/ur5e.urdf"), "tool0")
        case "jaco":
            return load_robot(_shipped("dm_control", "third_party/kinova/jaco_arm.xml"))
        case _:
            return load_robot(name)


def _shipped(package: str, file: str) -> str:
    spec = find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        raise UserError(f"Install the dev extra: {package} is missing.")
    return str(Path(next(iter(spec.submodule_search_locations))) / file)


def drive(robot: Robot, harm: str, period_s: float, rng: np.random.Generator) -> float:
    """Push, then stop, and return the least distance of the drive, m."""
    obstacles, judge, q, push = scene(robot, harm, rng)
    controller = Pusher(robot.dof)
    step = Step(robot, controller, SafetyConfig(obstacles=obstacles), dt_s=period_s)
    step.reset(q)
    at_rest = np.zeros(robot.dof)
    hand = None if robot.gripper is None else GripperReading(robot.gripper.width_m)
    step(Input(np.zeros(1)), 0.0, Reading(q, at_rest, 0.0, 0, hand), 0.0)
    if step.enable() is not None:
        raise RuntimeError("the arm could not be enabled")
    ticks, look = round(PUSH_S / period_s), round(LOOK_S / period_s)
    least = np.inf
    for tick in range(ticks + round(0.3 / period_s)):
        if tick == ticks:
            step.stop("The drive is over.")
        if tick % max(1, round(0.05 / period_s)) == 0:
            controller.wanted = push.towards(q)
        now_s = (tick + 1) * period_s
        record = step(Input(np.ones(1)), 0.0, Reading(q, at_rest, now_s, tick + 1, hand), now_s)
        if record.command.stop is not None and tick < ticks:
            raise RuntimeError(f"stopped: {record.command.stop.reason}")
        q = q + record.command.velocity * period_s
        if tick % look == 0:
            least = min(least, float(judge.distances(q).min()))
    return least
