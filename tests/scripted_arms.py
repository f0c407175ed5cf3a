"""Fixtures of tests of safety and control: arms, a scripted controller, an oracle of distances."""

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
import pytest

from latentarm.assistance.controllers.contract import Controller
from latentarm.core.types import Context, FloatArray
from latentarm.models.enclosure import linear_enclosure
from latentarm.robots.assemble import assemble
from latentarm.robots.kinematics.distances import segment_distance
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Obstacle, Sphere
from latentarm.robots.limits import JointLimits
from latentarm.robots.panda import panda
from latentarm.robots.planar import planar
from latentarm.robots.robot import Robot

# Joints that follow others: sliding segments of which the innermost leads, one of them a follower's follower
# that goes the other way, and two that turn with a leader between them.
COUPLED: Final = """
<mujoco model="coupled">
  <compiler angle="radian"/>
  <worldbody>
    <body name="mast" pos="0 0 0.5">
      <joint name="turn" axis="0 0 1" range="-3 3"/>
      <joint name="tilt" axis="0 1 0" ref="0.1" pos="0 0.02 0" range="-1 1.5"/>
      <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.05"/>
      <body name="outer" pos="0.3 0 0" euler="0.2 0 0">
        <joint name="first" type="slide" axis="1 0 0" ref="0.03" range="0 0.13"/>
        <geom type="capsule" fromto="-0.1 0 0 0 0 0" size="0.04"/>
        <body name="middle" pos="0.02 0 0">
          <joint name="second" type="slide" axis="1 0 0" range="-0.1 0.1"/>
          <geom type="capsule" fromto="-0.1 0 0 0 0 0" size="0.03"/>
          <body name="inner" pos="0.02 0 0" quat="0 0 0 1">
            <joint name="third" type="slide" axis="-1 0 0" range="0.02 0.13"/>
            <geom type="capsule" fromto="0.1 0 0 0 0 0" size="0.02"/>
            <body name="hand" pos="-0.1 0 0">
              <joint name="nod" axis="0 1 0" range="-2.6 2.6"/>
              <geom type="capsule" fromto="0 0 0 -0.2 0 0" size="0.02"/>
              <body name="end" pos="-0.2 0 0">
                <joint name="roll" axis="1 0.2 0" pos="0 0.01 0"/>
                <geom type="capsule" fromto="0 0 0 -0.1 0 0" size="0.02"/>
                <site name="tip" pos="-0.1 0.05 0"/>
              </body>
            </body>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <equality>
    <joint joint1="first" joint2="third" polycoef="0.01 1 0 0 0"/>
    <joint joint1="second" joint2="first" polycoef="0 -0.5 0 0 0"/>
    <joint joint1="roll" joint2="nod" polycoef="0.3 -1.5 0 0 0"/>
    <joint joint1="tilt" joint2="nod" polycoef="0 0.5 0 0 0"/>
  </equality>
</mujoco>
"""


@pytest.fixture(scope="session")
def arm() -> Robot:
    return panda()


@pytest.fixture(scope="session")
def two_arms() -> Robot:
    return planar(n_links=5, arms=2)


@pytest.fixture(scope="session")
def gantry() -> Robot:
    """A robot that slides before it turns and turns before it slides."""
    text = """
    <mujoco><compiler angle="radian"/><worldbody>
      <body><joint name="rail" type="slide" axis="1 0 0" range="-0.5 0.5"/>
        <geom type="capsule" fromto="0 0 0 0 0 0.3" size="0.05" mass="1"/>
        <body pos="0 0 0.4"><joint name="turn" axis="0 1 0" range="-2 2"/>
          <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04" mass="1"/>
          <body pos="0.4 0.1 0"><joint name="push" type="slide" axis="1 0 0" range="0 0.3"/>
            <geom type="capsule" fromto="0 0 0 0.1 0 0" size="0.03" mass="1"/>
            <body pos="0.1 0 0"><joint name="wrist" axis="0 0 1" range="-2 2"/>
              <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.03" mass="1"/>
              <site name="tool" pos="0.2 0.05 0"/>
    </body></body></body></body></worldbody></mujoco>"""
    limits = JointLimits(
        lower=np.array([-0.5, -2.0, 0.0, -2.0]),
        upper=np.array([0.5, 2.0, 0.3, 2.0]),
        velocity=np.full(4, 2.0),
        acceleration=np.full(4, 10.0),
        jerk=np.full(4, 1000.0),
    )
    return assemble("gantry", text, ["tool"], limits, np.array([0.0, 0.3, 0.1, 0.2]), 2.0)


@pytest.fixture(scope="session")
def coupled() -> Robot:
    limits = JointLimits(
        lower=np.array([-3.0, 0.02, -2.6]),
        upper=np.array([3.0, 0.12, 2.6]),
        velocity=np.full(3, 2.0),
        acceleration=np.full(3, 10.0),
        jerk=np.full(3, 1000.0),
    )
    return assemble("coupled", COUPLED, ["tip"], limits, np.array([0.0, 0.07, 0.3]), 2.0)


@pytest.fixture(scope="session")
def robot_named(request: pytest.FixtureRequest) -> Callable[[str], Robot]:
    """One of the above by its name; Hypothesis would write each robot that a test takes out in full."""
    return request.getfixturevalue


class Scripted(Controller):
    """Does what it is told to: ``action(z) = z @ matrix``, or what ``answer`` returns."""

    def __init__(self, matrix: FloatArray, modes: tuple[str, ...] = ("only",)) -> None:
        self.matrix = matrix
        self._modes = modes
        self.answer: Callable[[Context], object] | None = None

    @property
    def modes(self) -> tuple[str, ...]:
        return self._modes

    @property
    def input_dim(self) -> int:
        return len(self.matrix)

    def latent(self, u: FloatArray, context: Context, mode: int) -> FloatArray:
        return u

    def action(self, z: FloatArray, context: Context, mode: int) -> FloatArray:
        if self.answer is not None:
            return self.answer(context)  # type: ignore[return-value]
        return z @ self.matrix

    def speed_bound(self, context: Context, mode: int) -> float:
        return float(linear_enclosure(self.matrix, np.zeros(self.matrix.shape[1])).largest())


@pytest.fixture(scope="session")
def scripted() -> type[Scripted]:
    return Scripted


class Oracle:
    """Distances and speeds worked out anew and slowly, in ways that the safety filters do not use."""

    def __init__(self, robot: Robot, obstacles: Sequence[Obstacle] = ()) -> None:
        self.robot = robot
        self.obstacles = tuple(obstacles)
        capsules, chain = robot.capsules, robot.chain
        # A capsule that turns about its own axis alone cannot come nearer to anything.
        rng = np.random.default_rng(0)
        q = rng.uniform(robot.limits.lower, robot.limits.upper, (8, robot.dof))
        starts, ends = capsules.placed(chain, chain.link_transforms(q))
        spread = np.maximum(np.ptp(starts, axis=0).max(-1), np.ptp(ends, axis=0).max(-1))
        self.moving = np.flatnonzero((capsules.link >= 0) & (spread > 1e-9))
        moves = [set(np.flatnonzero(chain.moves[link])) if link >= 0 else set() for link in capsules.link]
        self.pairs = np.array(
            [(i, j) for i, j in robot.self_pairs if moves[i] != moves[j]], dtype=np.int64
        ).reshape(-1, 2)

    def ends(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        return self.robot.capsules.placed(self.robot.chain, self.robot.chain.link_transforms(q))

    def distances(self, q: FloatArray) -> FloatArray:
        """(..., pairs): the arm's own pairs, then every moving capsule to every obstacle."""
        starts, ends = self.ends(q)
        radius = self.robot.capsules.radius
        i, j = self.pairs.T
        own, _, _ = segment_distance(starts[..., i, :], ends[..., i, :], starts[..., j, :], ends[..., j, :])
        found = [own - radius[i] - radius[j]]
        a, b, r = starts[..., self.moving, :], ends[..., self.moving, :], radius[self.moving]
        for item in self.obstacles:
            match item:
                case HalfSpace():
                    low = np.minimum((a - item.point) @ item.normal, (b - item.point) @ item.normal)
                    found.append(low - r)
                case Sphere():
                    centre = np.broadcast_to(item.centre, a.shape)
                    found.append(segment_distance(a, b, centre, centre)[0] - r - item.radius)
                case Capsule():
                    start, end = np.broadcast_to(item.start, a.shape), np.broadcast_to(item.end, a.shape)
                    found.append(segment_distance(a, b, start, end)[0] - r - item.radius)
                case Box():
                    found.append(box_distance(a, b, item) - r)
        return np.concatenate(found, axis=-1)

    def clearance(self, q: FloatArray) -> FloatArray:
        return self.distances(q).min(axis=-1)

    def link_speed(self, q: FloatArray, velocity: FloatArray) -> float:
        """Fastest tool, capsule end, or point of its surface along the link's axes; central differences."""
        capsules, chain = self.robot.capsules, self.robot.chain
        out = np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])
        ends = np.concatenate([capsules.start, capsules.end])
        around = ends[:, None] + np.tile(capsules.radius, 2)[:, None, None] * out
        link = np.repeat(np.tile(capsules.link, 2), len(out))
        step = 1e-6
        fast = []
        for sign in (1.0, -1.0):
            transforms = chain.link_transforms(q + sign * step * velocity)
            tools = [chain.tool_pose(transforms, tool).position[None] for tool in range(len(chain.tools))]
            fast.append(np.concatenate([chain.points(transforms, link, around.reshape(-1, 3)), *tools]))
        return float(np.linalg.norm((fast[0] - fast[1]) / (2 * step), axis=-1).max())


def box_distance(a: FloatArray, b: FloatArray, box: Box) -> FloatArray:
    """Distance of segments to a box, whose square is convex along a segment, by bisection; zero inside."""
    a, b = (a - box.centre) @ box.rotation, (b - box.centre) @ box.rotation
    way = b - a

    def outside(s: FloatArray) -> FloatArray:
        at = a + s[..., None] * way
        return at - np.clip(at, -box.half_extents, box.half_extents)

    low, high = np.zeros(a.shape[:-1]), np.ones(a.shape[:-1])
    for _ in range(40):
        middle = (low + high) / 2
        rises = np.vecdot(outside(middle), way) > 0
        low, high = np.where(rises, low, middle), np.where(rises, middle, high)
    return np.linalg.norm(outside((low + high) / 2), axis=-1)


@pytest.fixture(scope="session")
def oracle() -> type[Oracle]:
    return Oracle
