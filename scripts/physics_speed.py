"""How many times faster than real time the physics runs, in processor time of one core.

    python scripts/physics_speed.py [--seconds 4] [--kind table]

Scenes: *alone*: the Panda waves about. *table*: it waves over a table with ten things and 40 grains, all at
rest. *poured*: it carries a cup with 40 grains over nine other things and pours them out.
"""

import argparse
import time
from collections.abc import Callable
from typing import Final

import numpy as np

from latentarm.arms.mujoco import STEP_S, MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.core.types import Command, FloatArray, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.robots.scene.containers import bowl, cup, packed, plate
from latentarm.robots.scene.scene import Scene
from latentarm.robots.scene.thing import Food, Grains, Part, Thing

TICK_S: Final = 0.01
SETTLE_S: Final = 2.0
GRAIN_M: Final = 0.005
GRAIN_KG: Final = 0.0005


def at(x: float, y: float, z: float = 0.0) -> Pose:
    """An upright pose."""
    return Pose(np.array([x, y, z]), np.eye(3))


def ten_things() -> tuple[Thing, ...]:
    """Two cups, two bowls, a plate with three marshmallows, a box and a can."""
    soft = Food(pierce_n=2.0, depth_m=0.008, grip_n=1.5)
    sweet = (Part("cylinder", (0.013, 0.012), (0.0, 0.0, 0.012)),)
    made = [
        Thing("cup", cup().parts, 0.2, at(0.5, 0.3), interior=cup().interior),
        Thing("other cup", cup().parts, 0.2, at(0.4, 0.35), interior=cup().interior),
        Thing("bowl", bowl().parts, 0.3, at(0.55, -0.3), interior=bowl().interior),
        Thing("other bowl", bowl().parts, 0.3, at(0.3, -0.4), interior=bowl().interior),
        Thing("plate", plate().parts, 0.4, at(0.6, 0.0)),
        *(
            Thing(f"sweet {i}", sweet, 0.007, at(0.6 + 0.05 * (i - 1), 0.03 * (-1) ** i, 0.005), food=soft)
            for i in range(3)
        ),
        Thing("box", (Part("box", (0.04, 0.06, 0.03), (0.0, 0.0, 0.03)),), 0.3, at(0.3, 0.5)),
        Thing("can", (Part("cylinder", (0.033, 0.06), (0.0, 0.0, 0.06)),), 0.35, at(0.75, 0.3)),
    ]
    return tuple(made)


def alone() -> tuple[Robot, Scene | None]:
    """Nothing about the arm."""
    return load_robot("panda"), None


def table() -> tuple[Robot, Scene | None]:
    """Ten things, and 40 grains in one of the cups."""
    things = ten_things()
    places = packed(cup().interior, things[0].pose, 40, GRAIN_M)
    return load_robot("panda"), Scene(things, (Grains("rice", GRAIN_M, GRAIN_KG, places),))


def poured() -> tuple[Robot, Scene | None]:
    """40 grains in the cup that the arm carries, level, and ten things on the table."""
    robot = load_robot("panda_cup")
    vessel = robot.attachment and robot.attachment.vessel
    if vessel is None:
        raise RuntimeError("panda_cup has no cup")
    pose = vessel.pose(robot.chain.forward(LEVEL))
    places = packed(vessel.interior, pose, 40, GRAIN_M)
    return robot, Scene(ten_things(), (Grains("rice", GRAIN_M, GRAIN_KG, places),))


LEVEL: Final = np.array([0.0, -0.2, 0.0, -2.2, 0.0, 3.57, 0.785])
"""The hand level, its x axis up."""


def waves(t: float) -> FloatArray:
    """(7,), velocities that stay near the start, rad/s."""
    return 0.25 * np.sin(2.0 * np.pi * (0.25 * t + np.arange(7) / 7.0))


def pours(t: float) -> FloatArray:
    """(7,), carries to one side for two seconds, then turns the hand over, rad/s."""
    velocity = np.zeros(7)
    if t < 2.0:
        velocity[0] = 0.3
    elif t < 4.0:
        velocity[6] = -1.0
    return velocity


KINDS: Final[dict[str, tuple[Callable[[], tuple[Robot, Scene | None]], Callable[[float], FloatArray]]]] = {
    "alone": (alone, waves),
    "table": (table, waves),
    "poured": (poured, pours),
}


def measure(kind: str, seconds: float) -> dict[str, float]:
    """Times faster than real time, and what it was like."""
    make, velocity = KINDS[kind]
    robot, scene = make()
    clock = SimulatedClock()
    start = LEVEL if kind == "poured" else robot.home
    arm = MujocoArm(robot, start, clock.now_s, scene=scene)
    arm.connect()
    arm.enable()
    for _ in range(round(SETTLE_S / TICK_S)):
        clock.wait_until(clock.now_s() + TICK_S)
        arm.read()
    contacts: list[int] = []
    slowest = 0.0
    begin = time.process_time()
    for tick in range(round(seconds / TICK_S)):
        before = time.process_time()
        arm.send(Command(velocity(tick * TICK_S), duration_s=0.025))
        clock.wait_until(clock.now_s() + TICK_S)
        arm.read()
        slowest = max(slowest, time.process_time() - before)
        contacts.append(arm.data.ncon)
    took = time.process_time() - begin
    return {
        "times_real_time": seconds / took,
        "us_per_step": 1e6 * took * STEP_S / seconds,
        "slowest_tick_ms": 1e3 * slowest,
        "contacts": float(np.mean(contacts)),
    }


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--kind", choices=KINDS, nargs="*", default=list(KINDS))
    arguments = parser.parse_args()
    print(f"{'scene':8} {'x real time':>12} {'us/step':>8} {'slowest tick, ms':>17} {'contacts':>9}")
    for kind in arguments.kind:
        row = measure(kind, arguments.seconds)
        print(
            f"{kind:8} {row['times_real_time']:12.1f} {row['us_per_step']:8.0f}"
            f" {row['slowest_tick_ms']:17.1f} {row['contacts']:9.0f}"
        )


if __name__ == "__main__":
    main()
