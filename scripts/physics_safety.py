"""What an arm in physics does to its limits, with late and noisy readings and a payload.

The safety filters decide by what they read. Here a Panda in MuJoCo with 1 kg at its tool, noise on its
readings, and readings that are 0 to 3 ticks late, is pushed at 100 Hz at walls, boxes, balls, rods and at
itself (`clearance_drives.py`), with full input that changes its direction 20 times a second. In every tick
the true positions and velocities of the joints, the speed of the ends of all capsules, and the distances by
`mujoco.mj_geomDistance` are compared with the configured limits.

    python scripts/physics_safety.py --ticks 100000
"""

import argparse
import json
from dataclasses import asdict, dataclass, field
from typing import Final

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from clearance_drives import HARMS, Pusher, scene
from enabled_arm import enabled
from latentarm.arms.mujoco import Imperfections, MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import FloatArray, Input
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from latentarm.safety.config import SafetyConfig

PERIOD_S: Final = 0.01
PUSH_TICKS: Final = 200
REST_TICKS: Final = 40
LATE_TICKS: Final = (0, 1, 2, 3)
PAYLOAD_KG: Final = 1.0
POSITION_NOISE_RAD: Final = 1e-4
VELOCITY_NOISE_RAD_S: Final = 1e-3

LIMITS: Final = {
    "position_rad": "position (rad)",
    "joint_speed_rad_s": "joint speed (rad/s)",
    "link_speed_m_s": "link speed (m/s)",
    "clearance_m": "clearance (m)",
}
"""The limits that are looked at, as fields of `Seen`, and what the table calls them."""


@dataclass
class Passed:
    """How far one limit was passed.

    Attributes:
        worst: by how much at most, in the limit's unit; 0 where it never was.
        ticks: in how many ticks it was.
    """

    worst: float = 0.0
    ticks: int = 0

    def look(self, excess: float) -> None:
        """Add a tick.

        Args:
            excess: by how much the limit is passed, negative within it.
        """
        self.worst = max(self.worst, excess)
        self.ticks += excess > 0.0


@dataclass
class Seen:
    """What came of all drives with one delay.

    Attributes:
        late_ticks: how late readings were.
        drives: how many there were.
        ticks: how many were looked at.
        stops: drives that a check of the readings ended.
        position_rad: joints nearer to their hardware limits than joint_margin.
        joint_speed_rad_s: joints faster than joint_speed.
        link_speed_m_s: ends of capsules faster than link_speed.
        clearance_m: distances below clearance.
        least_m: the least distance, m.
    """

    late_ticks: int
    drives: int = 0
    ticks: int = 0
    stops: int = 0
    position_rad: Passed = field(default_factory=Passed)
    joint_speed_rad_s: Passed = field(default_factory=Passed)
    link_speed_m_s: Passed = field(default_factory=Passed)
    clearance_m: Passed = field(default_factory=Passed)
    least_m: float = np.inf


def imperfect(late_ticks: int, rng: np.random.Generator) -> Imperfections:
    """An arm with a payload, and noise on readings that are so many ticks late."""
    return Imperfections(
        position_noise_rad=POSITION_NOISE_RAD,
        velocity_noise_rad_s=VELOCITY_NOISE_RAD_S,
        delay_s=PERIOD_S * late_ticks,
        payload_kg=PAYLOAD_KG,
        seed=int(rng.integers(2**31)),
    )


def ends(robot: Robot, q: FloatArray) -> FloatArray:
    """(2 K, 3), both ends of all capsules, m."""
    return np.concatenate(robot.capsules.placed(robot.chain, robot.chain.link_transforms(q)))


def drive(robot: Robot, harm: str, seen: Seen, rng: np.random.Generator) -> None:
    """Push once, and let go."""
    obstacles, judge, start, push = scene(robot, harm, rng)
    config = SafetyConfig(obstacles=obstacles)
    controller, clock = Pusher(robot.dof), SimulatedClock()
    arm = MujocoArm(
        robot,
        start,
        clock.now_s,
        imperfect(seen.late_ticks, rng),
    )
    step = Step(robot, controller, config, dt_s=PERIOD_S)
    first = enabled(arm, step, clock, seen.late_ticks)
    before = ends(robot, arm.truth()[0])
    seen.drives += 1
    stopped = False
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
        distance = float(judge.distances(q).min())
        seen.ticks += 1
        seen.position_rad.look(config.joint_margin - float(margin(robot, q)))
        seen.joint_speed_rad_s.look(float(np.abs(dq).max()) - config.joint_speed)
        speed = np.linalg.norm(now - before, axis=1).max() / PERIOD_S
        seen.link_speed_m_s.look(float(speed) - config.link_speed)
        seen.clearance_m.look(config.clearance - distance)
        seen.least_m = min(seen.least_m, distance)
        before = now
    seen.stops += stopped


def margin(robot: Robot, q: FloatArray) -> float:
    """How far the joint nearest to its limit is from it, rad."""
    return float(np.minimum(q - robot.limits.lower, robot.limits.upper - q).min())


def main() -> None:
    """Drive, and print a table or JSON."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--ticks", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true")
    config = parser.parse_args()
    robot = panda()
    seen = [Seen(late) for late in LATE_TICKS]
    drives = -(-config.ticks // (PUSH_TICKS + REST_TICKS))
    for number in track(range(drives), "drives", console=Console(stderr=True), disable=config.json):
        rng = np.random.default_rng([config.seed, number])
        drive(robot, HARMS[number % len(HARMS)], seen[(number // len(HARMS)) % len(LATE_TICKS)], rng)
    if config.json:
        print(json.dumps([asdict(one) for one in seen], indent=1))
        return
    table = Table("ticks late", "drives", "ticks", "stops", *LIMITS.values(), "least distance (mm)")
    for one in seen:
        passed = [getattr(one, name) for name in LIMITS]
        texts = [f"{each.worst:.4f} in {each.ticks}" for each in passed]
        table.add_row(
            *(str(value) for value in (one.late_ticks, one.drives, one.ticks, one.stops)),
            *texts,
            f"{1000.0 * one.least_m:.2f}",
        )
    Console(width=150).print(table, "limit passed by at most, and in how many ticks")


if __name__ == "__main__":
    main()
