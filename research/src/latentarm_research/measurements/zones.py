"""Measure how fast an arm is in a zone: a Panda, exact and in physics, pushed into balls at full speed.

In each drive a ball is somewhere about the tool. A full push leads the tool into the ball, then away from
it; 20 times a second there is a chance of one in five that it leads anywhere instead. The physical arm has
1 kg at its tool that the filters do not know of, noise on its readings, and readings that are late. In every
tick of 10 ms each part of the arm that reaches into the ball counts by how far the faster end of its
capsule, or the tool, moved in that tick.
"""

from itertools import product
from typing import Final

import numpy as np

from latentarm.arms.kinematic import KinematicArm
from latentarm.arms.mujoco import MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import FloatArray, Input
from latentarm.robots.kinematics.distances import segment_distance
from latentarm.robots.kinematics.obstacles import Sphere
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig
from latentarm.safety.zones import Zone
from latentarm_research.measurements.catalogue import Drives
from latentarm_research.measurements.measurement import Outcome, Work, line
from latentarm_research.measurements.pushing import PERIOD_S, Pusher, enabled, imperfect

CONDITIONS: Final = tuple(product((None, 0, 3), (0.03, 0.1)))
"""How late readings are, ticks (None: the arm moves exactly as commanded), and the zone's speed, m/s."""

IN_TICKS: Final = 200
OUT_TICKS: Final = 300
TURN_TICKS: Final = 5
PUSH_M_PER_S: Final = 0.25


def measure(options: Drives, work: Work) -> Outcome:
    """Ticks in the zone, the fastest part there, and ticks above its speed; the exact arm may have none."""
    numbers = range(options.drives * len(CONDITIONS) // 2)
    found = work.each(drive, [(work.seed, number) for number in numbers])
    rows, broken = [], list[str]()
    for index, (late, speed) in enumerate(CONDITIONS):
        mine = np.array(found[index :: len(CONDITIONS)]).reshape(-1, 4)
        name = f"{'exact' if late is None else f'in physics, {late} ticks late'}, at most {speed} m/s"
        stops, inside, above = mine[:, :3].sum(axis=0)
        figures = {"stops": stops, "in_zone_ticks": inside, "above_speed_ticks": above}
        rows += line("zones", name, len(mine), {**figures, "fastest_m_s": mine[:, 3].max(initial=0.0)})
        broken += [f"{name}: too fast in {above:.0f} ticks"] * bool(late is None and above)
    return Outcome(rows, broken)


def parts(robot: Robot, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Starts and ends (K + 1, 3), m, and radii (K + 1,), m, of the moving capsules and the tool."""
    capsules, transforms = robot.capsules, robot.chain.link_transforms(q)
    moving = capsules.link >= 0
    starts, ends = capsules.placed(robot.chain, transforms)
    tool = robot.chain.tool_pose(transforms).position[None]
    radius = np.append(capsules.radius[moving], 0.0)
    return np.concatenate([starts[moving], tool]), np.concatenate([ends[moving], tool]), radius


def drive(cell: tuple[int, int]) -> tuple[bool, int, int, float]:
    """Push in, then out.

    Returns whether a check stopped the arm, in how many ticks a part was in the zone, in how many one was too
    fast there, and the fastest, m/s.
    """
    robot, rng = panda(), np.random.default_rng(cell)
    late_ticks, speed = CONDITIONS[cell[1] % len(CONDITIONS)]
    start = np.clip(
        robot.home + 0.15 * rng.normal(size=robot.dof), robot.limits.lower + 0.2, robot.limits.upper - 0.2
    )
    away = rng.normal(size=3)
    centre = robot.chain.forward(start).position + away * (rng.uniform(0.22, 0.3) / np.sqrt(away @ away))
    ball = Sphere("face", centre, rng.uniform(0.06, 0.1))
    clock, controller = SimulatedClock(), Pusher(robot.dof)
    late = late_ticks or 0
    arm = (
        KinematicArm(robot, start, clock.now_s)
        if late_ticks is None
        else MujocoArm(robot, start, clock.now_s, imperfect(late, rng))
    )
    step = Step(robot, controller, SafetyConfig(zones=(Zone(ball, speed),)), dt_s=PERIOD_S)
    first = enabled(arm, step, clock, late)
    stopped, inside, too_fast, fastest, before = False, 0, 0, 0.0, None
    for tick in range(IN_TICKS + OUT_TICKS):
        clock.wait_until(PERIOD_S * (first + tick))
        q = arm.truth()[0] if isinstance(arm, MujocoArm) else arm.read().q
        if tick % TURN_TICKS == 0:
            way = centre - robot.chain.forward(q).position if tick < IN_TICKS else -away
            if rng.uniform() < 0.2:
                way = rng.normal(size=3)
            tool = np.concatenate([PUSH_M_PER_S * way / np.sqrt(way @ way), np.zeros(3)])
            controller.wanted = np.linalg.pinv(robot.chain.jacobian(q), rcond=0.05) @ tool
        record = step(Input(np.ones(1)), 0.0, arm.read(), clock.now_s())
        stopped |= record.command.stop is not None
        arm.send(record.command)
        starts, ends, radius = parts(robot, q)
        within = segment_distance(starts, ends, centre, centre)[0] - radius <= ball.radius
        if before is not None:
            gone = [
                np.sqrt(((now - was) ** 2).sum(axis=1))
                for now, was in zip((starts, ends), before, strict=True)
            ]
            now_m_s = float((np.maximum(*gone) * within).max()) / PERIOD_S
            fastest = max(fastest, now_m_s)
            too_fast += now_m_s > speed + 1e-9
        inside += bool(within.any())
        before = (starts, ends)
    return stopped, inside, too_fast, fastest
