"""Pushes of an arm at something near it or at itself, and arms in physics as filters do not know them."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from scipy.spatial.transform import Rotation

from latentarm.arms.kinematic import KinematicArm
from latentarm.arms.mujoco import Imperfections, MujocoArm
from latentarm.assistance.controllers.contract import Controller
from latentarm.control.clock import SimulatedClock
from latentarm.control.step import Step
from latentarm.core.types import Context, FloatArray, Input
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.robots.robot import Robot
from latentarm.safety.body import Body
from latentarm.safety.config import SafetyConfig
from latentarm.safety.filter import GuardedArm, Situation
from latentarm.safety.limits import Bounds
from latentarm_research.measurements.geom_distances import Judge

HARMS: Final = ("wall", "box", "ball", "rod", "itself")
TRAY: Final = "tray"  # a level box, on which a held thing may be put down

START_M: Final = 0.03


@final
class Pusher(Controller):
    """Moves the arm along a given joint velocity, with one axis of input."""

    def __init__(self, dof: int) -> None:
        self.wanted: FloatArray = np.zeros(dof)

    @property
    def modes(self) -> tuple[str, ...]:
        """See the base class."""
        return ("push",)

    @property
    def input_dim(self) -> int:
        """See the base class."""
        return 1

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        """See the base class."""
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        """See the base class."""
        return z * self.wanted


@final
@dataclass(frozen=True)
class Push:
    """A point of the arm, and where it is pushed to."""

    robot: Robot
    link: int  # the link that carries the point
    local: FloatArray  # (3,), the point in its link's frame, m
    target: FloatArray | None  # (3,), where to, m; None for another part of the arm
    other: int = 0  # the capsule that it is pushed to where there is no target

    def at(self, q: FloatArray) -> FloatArray:
        """The point in the base frame, (..., 3), m, for configurations (..., n)."""
        transforms = self.robot.chain.link_transforms(q)
        return self.robot.chain.points(transforms, np.array([self.link]), self.local[None])[..., 0, :]

    def towards(self, q: FloatArray) -> FloatArray:
        """(n,), the steepest way there, twice as fast as the fastest joint could be wanted, rad/s."""
        target = self.target
        if target is None:
            chain, capsules = self.robot.chain, self.robot.capsules
            start, end = capsules.placed(chain, chain.link_transforms(q))
            target = 0.5 * (start + end)[self.other]
        nudge = 1e-5 * np.eye(len(q))
        slope = (self.at(q + nudge) - self.at(q - nudge)) @ (target - self.at(q))
        return 2.0 * slope / max(float(np.abs(slope).max()), 1e-12)


def scene(
    robot: Robot, harm: str, rng: np.random.Generator
) -> tuple[tuple[Obstacle, ...], Judge, FloatArray, Push]:
    """Obstacles, their judge, a start and a push, with all distances above `START_M`.

    Nor is a distance too small by the filters' own capsules: from such a start they promise nothing.
    """
    limits, capsules, chain = robot.limits, robot.capsules, robot.chain
    outer = np.flatnonzero(capsules.link >= max(1, robot.dof // 3))[-robot.held :]  # what is held, if any
    while True:
        q = rng.uniform(limits.lower + 0.15, limits.upper - 0.15)
        starts, ends = capsules.placed(chain, chain.link_transforms(q))
        k, share = int(rng.choice(outer)), rng.uniform()
        local = (1 - share) * capsules.start[k] + share * capsules.end[k]
        at = (1 - share) * starts[k] + share * ends[k]
        out = rng.normal(size=3)
        if robot.name.startswith("planar"):
            out[2] = 0.0
        out /= np.linalg.norm(out)
        gap = capsules.radius[k] + rng.uniform(0.04, 0.2)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        table = HalfSpace("table", np.zeros(3), np.array([0.0, 0.0, 1.0]))
        size = rng.uniform(0.02, 0.1)
        middle = at + (gap + size) * out
        match harm:
            case "wall":
                thing = HalfSpace("wall", at + gap * out, -out)
            case "ball":
                thing = Sphere("ball", middle, size)
            case "rod":
                across = np.cross(out, turn[:, 0]) * rng.uniform(0.1, 0.4)
                thing = Capsule("rod", middle - across, middle + across, size)
            case "tray":
                turn = Rotation.from_euler("z", rng.uniform(0.0, np.pi)).as_matrix()
                thing = Box(TRAY, middle, turn, rng.uniform(0.3, 2.0, 3) * size)
            case _:
                thing = Box("box", middle, turn, rng.uniform(0.3, 1.0, 3) * size)
        obstacles = (table,) if harm == "itself" else (table, thing)
        far = np.flatnonzero(np.abs(capsules.link - capsules.link[k]) > 1)
        target = None if harm == "itself" else middle
        push = Push(robot, int(capsules.link[k]), local, target, int(rng.choice(far)))
        judge = Judge(robot, obstacles)
        if judge.distances(q).min() > START_M and _allowed(robot, obstacles, q):
            return obstacles, judge, q, push


def _allowed(robot: Robot, obstacles: tuple[Obstacle, ...], q: FloatArray) -> bool:
    """True if the filters count no distance as too small at q (n,), rad."""
    config, still = SafetyConfig(obstacles=obstacles), np.zeros(robot.dof)
    arm = GuardedArm(Bounds(config, robot, PERIOD_S), Body(robot))
    height = Situation(arm, q, still, still).contacts_now().height
    return bool((height >= config.clearance).all())


PERIOD_S: Final = 0.01
LATE_TICKS: Final = (0, 1, 2, 3)
PAYLOAD_KG: Final = 1.0
POSITION_NOISE_RAD: Final = 1e-4
VELOCITY_NOISE_RAD_S: Final = 1e-3


def imperfect(late_ticks: int, rng: np.random.Generator) -> Imperfections:
    """An arm with a payload, and noise on readings that are so many ticks late."""
    return Imperfections(
        position_noise_rad=POSITION_NOISE_RAD,
        velocity_noise_rad_s=VELOCITY_NOISE_RAD_S,
        delay_s=PERIOD_S * late_ticks,
        payload_kg=PAYLOAD_KG,
        seed=int(rng.integers(2**31)),
    )


def enabled(
    arm: KinematicArm | MujocoArm,  # not connected yet
    step: Step,
    clock: SimulatedClock,
    late_ticks: int,  # how old its readings are, ticks of the step
    inputs: int = 1,
) -> int:
    """Connect an arm, read it until its first late reading is there, enable it; the tick it may move from."""
    arm.connect()
    for tick in range(late_ticks + 2):
        clock.wait_until(step.dt_s * tick)
        reading = arm.read()
        if tick == 0:
            step.reset(reading.q)
        step(Input(np.zeros(inputs)), 0.0, reading, clock.now_s())
    arm.enable()
    if (refused := step.enable()) is not None:
        raise RuntimeError(f"the arm could not be enabled: {refused.reason}")
    return late_ticks + 2
