"""How fast an arm really is in a zone: a Panda, exact and in physics, pushed into balls at full speed.

In each drive a ball is somewhere about the tool. A full push leads the tool into the ball, then away from
it; 20 times a second there is a chance of one in five that it leads anywhere instead. The physical arm has
1 kg at its tool that the filters do not know of, noise on its readings, and readings that are late. In every
tick of 10 ms each part of the arm that reaches into the ball is looked at: how far the faster end of its
capsule, or the tool, has gone in that tick. For example:

    python scripts/zone_drives.py --drives 30
"""

import argparse
import json
from dataclasses import asdict, dataclass
from typing import Final

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from clearance_drives import Pusher
from enabled_arm import enabled
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
from physics_safety import PERIOD_S, imperfect

SPEEDS: Final = (0.03, 0.1)
LATE_TICKS: Final = (None, 0, 3)
"""How late readings of the physical arm are; None is the arm that moves exactly as it is told."""

IN_TICKS: Final = 200
OUT_TICKS: Final = 300
TURN_TICKS: Final = 5
PUSH_M_PER_S: Final = 0.25


@dataclass
class Seen:
    """What came of all drives with one arm and one zone's speed.

    Attributes:
        late_ticks: how late readings were; None for the arm that is exact.
        speed: what the zone allows, m/s.
        drives: how many there were.
        ticks: how many ticks a part was in the zone for.
        fastest: of any part in the zone, m/s.
        too_fast: in how many ticks one was faster than the zone allows.
        stops: drives that a check of the readings ended.
    """

    late_ticks: int | None
    speed: float
    drives: int = 0
    ticks: int = 0
    fastest: float = 0.0
    too_fast: int = 0
    stops: int = 0


def parts(robot: Robot, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Starts and ends (K + 1, 3), m, and radii (K + 1,), m, of the moving capsules and the tool."""
    capsules, transforms = robot.capsules, robot.chain.link_transforms(q)
    moving = capsules.link >= 0
    starts, ends = capsules.placed(robot.chain, transforms)
    tool = robot.chain.tool_pose(transforms).position[None]
    radius = np.append(capsules.radius[moving], 0.0)
    return np.concatenate([starts[moving], tool]), np.concatenate([ends[moving], tool]), radius


def drive(robot: Robot, seen: Seen, rng: np.random.Generator) -> None:
    """Push in, then out."""
    start = np.clip(
        robot.home + 0.15 * rng.normal(size=robot.dof), robot.limits.lower + 0.2, robot.limits.upper - 0.2
    )
    away = rng.normal(size=3)
    centre = robot.chain.forward(start).position + away * (rng.uniform(0.22, 0.3) / np.sqrt(away @ away))
    ball = Sphere("face", centre, rng.uniform(0.06, 0.1))
    clock, controller = SimulatedClock(), Pusher(robot.dof)
    late = seen.late_ticks or 0
    arm = (
        KinematicArm(robot, start, clock.now_s)
        if seen.late_ticks is None
        else MujocoArm(robot, start, clock.now_s, imperfect(late, rng))
    )
    step = Step(robot, controller, SafetyConfig(zones=(Zone(ball, seen.speed),)), dt_s=PERIOD_S)
    first = enabled(arm, step, clock, late)
    seen.drives += 1
    stopped = False
    before = None
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
            fastest = float((np.maximum(*gone) * within).max()) / PERIOD_S
            seen.fastest = max(seen.fastest, fastest)
            seen.too_fast += fastest > seen.speed + 1e-9
        seen.ticks += bool(within.any())
        before = (starts, ends)
    seen.stops += stopped


def main() -> None:
    """Drive, and print a table or JSON."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--drives", type=int, default=30, help="with each arm")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true")
    config = parser.parse_args()
    robot = panda()
    seen = [Seen(late, speed) for late in LATE_TICKS for speed in SPEEDS]
    total = config.drives * len(LATE_TICKS)
    for number in track(range(total), "drives", console=Console(stderr=True), disable=config.json):
        drive(robot, seen[number % len(seen)], np.random.default_rng([config.seed, number]))
    if config.json:
        print(json.dumps([asdict(one) for one in seen], indent=1))
        return
    columns = (
        "ticks late",
        "allowed (m/s)",
        "drives",
        "stops",
        "ticks in it",
        "fastest",
        "too fast",
    )
    table = Table(*columns)
    for one in seen:
        late = "exact" if one.late_ticks is None else one.late_ticks
        table.add_row(
            *(str(value) for value in (late, one.speed, one.drives, one.stops, one.ticks)),
            f"{one.fastest:.4f}",
            str(one.too_fast),
        )
    Console(width=150).print(table)


if __name__ == "__main__":
    main()
