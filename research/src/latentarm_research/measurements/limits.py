"""Compare the true state of an imperfect arm in physics with the configured limits.

The safety filters decide by what they read. Here a Panda in MuJoCo with 1 kg at its tool, noise on its
readings, and readings that are 0 to 3 ticks late, is pushed at 100 Hz at walls, boxes, balls, rods and at
itself, with full input that changes its direction 20 times a second. Every tick, the true positions and
velocities of the joints, the speed of the ends of all capsules, and the distances by `Judge` are compared
with the limits.
"""

from typing import Final

import numpy as np

from latentarm.arms.mujoco import MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import FloatArray, Input
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig
from latentarm_research.measurements.catalogue import Limits
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.pushing import (
    HARMS,
    LATE_TICKS,
    PERIOD_S,
    Pusher,
    enabled,
    imperfect,
    scene,
)

PUSH_TICKS: Final = 200
REST_TICKS: Final = 40
LIMITS: Final = (
    ("joint_position", "rad"),
    ("joint_speed", "rad_s"),
    ("link_speed", "m_s"),
    ("clearance", "m"),
)


def measure(options: Limits, work: Work) -> Outcome:
    """By how much each limit is passed at most, and in how many ticks, for each delay of readings."""
    numbers = range(-(-options.ticks // (PUSH_TICKS + REST_TICKS)))
    found = work.each(drive, [(work.seed, number) for number in numbers])
    rows = []
    for late in LATE_TICKS:
        mine = [one for number, one in zip(numbers, found, strict=True) if late_of(number) == late]
        if not mine:
            continue
        excess = np.concatenate([each for each, _ in mine])
        figures: dict[str, float] = {"ticks": len(excess), "stops": sum(stopped for _, stopped in mine)}
        passed = (excess.max(axis=0), (excess > 0.0).sum(axis=0))
        for (limit, unit), worst, ticks in zip(LIMITS, *passed, strict=True):
            figures |= {f"past_{limit}_{unit}": max(0.0, worst), f"past_{limit}_ticks": ticks}
        figures["least_distance_mm"] = 1000 * (SafetyConfig().clearance - excess[:, 3].max())
        rows += line("limits", f"{late} ticks late", len(mine), figures)
    return Outcome(rows)


def late_of(number: int) -> int:
    """How late readings are in a drive, ticks."""
    return LATE_TICKS[number // len(HARMS) % len(LATE_TICKS)]


def drive(cell: tuple[int, int]) -> tuple[FloatArray, bool]:
    """By how much a push passes each limit, (ticks, 4), negative within it; whether a check stopped it."""
    robot, rng, late = panda(), np.random.default_rng(cell), late_of(cell[1])
    obstacles, judge, start, push = scene(robot, HARMS[cell[1] % len(HARMS)], rng)
    config = SafetyConfig(obstacles=obstacles)
    controller, clock = Pusher(robot.dof), SimulatedClock()
    arm = MujocoArm(robot, start, clock.now_s, imperfect(late, rng))
    step = Step(robot, controller, config, dt_s=PERIOD_S)
    first = enabled(arm, step, clock, late)
    before = ends(robot, arm.truth()[0])
    excess, stopped = list[tuple[float, ...]](), False
    for tick in range(PUSH_TICKS + REST_TICKS):
        clock.wait_until(PERIOD_S * (first + tick))
        q, dq = arm.truth()
        if tick % 5 == 0:
            # Mostly at what harms, else anywhere: what comes next is not what the last command was.
            away = rng.uniform(-2.0, 2.0, robot.dof)
            controller.wanted = push.towards(q) if rng.uniform() < 0.8 else away
        u = np.ones(1) if tick < PUSH_TICKS else np.zeros(1)
        record = step(Input(u), 0.0, arm.read(), clock.now_s())
        stopped |= record.command.stop is not None
        arm.send(record.command)
        now = ends(robot, q)
        to_end = np.minimum(q - robot.limits.lower, robot.limits.upper - q).min()
        excess.append(
            (
                config.joint_margin - float(to_end),
                float(np.abs(dq).max()) - config.joint_speed,
                float(np.linalg.norm(now - before, axis=1).max()) / PERIOD_S - config.link_speed,
                config.clearance - float(judge.distances(q).min()),
            )
        )
        before = now
    return np.array(excess), stopped


def ends(robot: Robot, q: FloatArray) -> FloatArray:
    """(2 K, 3), both ends of all capsules, m."""
    return np.concatenate(robot.capsules.placed(robot.chain, robot.chain.link_transforms(q)))
