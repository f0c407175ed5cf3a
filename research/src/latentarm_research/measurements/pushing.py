"""Pushes of an arm at something near it, or at another part of itself."""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import Context, FloatArray
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.robots.robot import Robot
from latentarm_research.measurements.geom_distances import Judge

HARMS: Final = ("wall", "box", "ball", "rod", "itself")

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
    """Obstacles, their judge, a start and a push, with all distances above `START_M`."""
    limits, capsules, chain = robot.limits, robot.capsules, robot.chain
    outer = np.flatnonzero(capsules.link >= max(1, robot.dof // 3))
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
            case _:
                thing = Box("box", middle, turn, rng.uniform(0.3, 1.0, 3) * size)
        obstacles = (table,) if harm == "itself" else (table, thing)
        far = np.flatnonzero(np.abs(capsules.link - capsules.link[k]) > 1)
        target = None if harm == "itself" else middle
        push = Push(robot, int(capsules.link[k]), local, target, int(rng.choice(far)))
        judge = Judge(robot, obstacles)
        if judge.distances(q).min() > START_M:
            return obstacles, judge, q, push
