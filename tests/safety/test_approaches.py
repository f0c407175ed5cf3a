"""A person who pushes with all they have towards harm: no limit is passed, and they can always back out."""

import itertools
from dataclasses import dataclass

import numpy as np
import pytest

from latentarm.control.step import Step
from latentarm.core.types import Input
from latentarm.robots.kinematics.obstacles import Box, Capsule, Sphere
from latentarm.safety.config import SafetyConfig
from latentarm.safety.obstacles import table
from stepping import stepped

now_s = itertools.count(step=0.01).__next__
"""The loop's clock, one period later each time."""

DT = 0.01
KINDS = ("table", "obstacle", "itself", "limits", "stretched")
QUICK, ALL, BLOCKS = 10, 500, 8


@dataclass
class Harm:
    """What a controller steers towards: a number of the state that shrinks as harm comes nearer."""

    kind: str
    measure: object
    limits: object
    goal: np.ndarray
    joints: np.ndarray

    def nearness(self, q):
        if self.kind == "limits":
            return -(q * self.joints).sum(-1)
        if self.kind == "stretched":
            return np.abs(q - self.goal).sum(-1)
        distances = self.measure.distances(q)
        own = len(self.measure.pairs)
        if self.kind == "itself":
            return distances[..., :own].min(-1)
        # The last obstacle, and the links that an arm reaches with.
        outer = self.measure.robot.capsules.link[self.measure.moving] >= 3
        return distances[..., -len(self.measure.moving) :][..., outer].min(-1)

    def towards(self, q):
        """Steepest descent, every joint as fast as it is told, (7,)."""
        nudge = 1e-5 * np.eye(len(q))
        slope = (self.nearness(q + nudge) - self.nearness(q - nudge)) / 2e-5
        largest = np.abs(slope).max()
        return np.zeros_like(q) if largest < 1e-9 else -slope / largest


def scene(arm, oracle, seed):
    rng = np.random.default_rng([2021, seed])
    kind = KINDS[seed % len(KINDS)]
    lower, upper = arm.limits.lower + 0.15, arm.limits.upper - 0.15
    while True:
        q = np.clip(arm.home + rng.normal(size=7) * 0.5, lower, upper)
        at = arm.chain.forward(q).position + rng.normal(size=3) * 0.15
        obstacles = [table(0.0)]
        if kind == "obstacle":
            turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            turn *= np.sign(np.linalg.det(turn))
            choices = (
                Sphere("ball", at, rng.uniform(0.02, 0.1)),
                Capsule("rod", at, at + rng.normal(size=3) * 0.2, rng.uniform(0.01, 0.05)),
                Box("box", at, turn, rng.uniform(0.02, 0.15, 3)),
            )
            obstacles.append(choices[rng.integers(3)])
        measure = oracle(arm, obstacles)
        if measure.clearance(q) > 0.03:
            break
    goal = q.copy()
    if kind == "stretched":
        # Elbow straight, wrist in line: where resolved rates would blow up.
        goal[[3, 5]] = arm.limits.upper[3], rng.choice([0.0, np.pi / 2])
        goal[1] = rng.uniform(-0.3, 1.2)
    joints = rng.choice([-1.0, 1.0], 7) * (rng.uniform(size=7) < 0.6)
    joints[rng.integers(7)] = rng.choice([-1.0, 1.0])
    return tuple(obstacles), q, Harm(kind, measure, arm.limits, goal, joints)


def approach_and_back_out(arm, oracle, scripted, seed):
    obstacles, q, harm = scene(arm, oracle, seed)
    controller = scripted(np.zeros((1, 7)))
    step = Step(arm, controller, SafetyConfig(obstacles=obstacles), dt_s=DT)
    stepped(step, Input(np.zeros(1)), 0.0, q, now_s())
    assert step.enable() is None
    bounds = step._stack.bounds
    states, hard_stops = [q], 0

    def push(u, ticks):
        nonlocal q, hard_stops
        for tick in range(ticks):
            if tick % 5 == 0:
                controller.matrix = harm.towards(q)[None] * 2.0
            record = stepped(step, Input(np.array([u])), 0.0, q, now_s())
            assert record.command.stop is None
            if tick % 10 == 0:
                assert harm.measure.link_speed(q, record.command.velocity) <= 0.25 + 1e-6
            hard_stops += step._stack._brake is not None
            q = q + record.command.velocity * DT
            states.append(q)

    push(1.0, 400)
    nearest = harm.nearness(q)
    blocked_at = q
    push(-1.0, 120)
    path = np.array(states)
    assert (path <= bounds.upper + 1e-9).all()
    assert (path >= bounds.lower - 1e-9).all()
    assert (harm.measure.clearance(path) >= 0.02 - 1e-8).all()
    speeds = np.diff(path, axis=0) / DT
    assert np.abs(speeds).max() <= 0.5 + 1e-9
    assert (np.abs(np.diff(speeds, axis=0)) <= bounds.stop_acceleration * DT + 1e-9).all()
    # Backing out: harm is measurably further away, and the arm has moved.
    assert harm.nearness(q) > nearest + 0.005
    assert np.abs(q - blocked_at).max() > 0.02
    return hard_stops


@pytest.mark.parametrize("seed", range(QUICK))
def test_no_limit_is_passed_and_the_operator_can_back_out(arm, oracle, scripted, seed):
    approach_and_back_out(arm, oracle, scripted, seed)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(BLOCKS))
def test_the_rest_of_five_hundred_approaches(arm, oracle, scripted, block):
    for seed in range(QUICK + block, ALL, BLOCKS):
        approach_and_back_out(arm, oracle, scripted, seed)


@pytest.mark.parametrize(
    "seed", [*range(4), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(4, 20))]
)
def test_an_arm_that_starts_too_near_can_be_driven_away_but_no_nearer(arm, oracle, scripted, seed):
    rng = np.random.default_rng([7, seed])
    while True:
        q = np.clip(arm.home + rng.normal(size=7) * 0.3, arm.limits.lower + 0.15, arm.limits.upper - 0.15)
        starts, _ends = oracle(arm).ends(q)
        out = rng.normal(size=3)
        out /= np.linalg.norm(out)
        ball = Sphere("ball", starts[-1] + out * (0.028 + 0.05 + rng.uniform(0.0, 0.015)), 0.05)
        measure = oracle(arm, (ball,))
        distances = measure.distances(q)
        if (
            (distances < 0.02).sum() >= 1
            and distances.min() > -0.01
            and measure.distances(q)[: len(measure.pairs)].min() > 0.03
        ):
            break
    harm = Harm("obstacle", measure, arm.limits, q, q)
    controller = scripted(np.zeros((1, 7)))
    step = Step(arm, controller, SafetyConfig(obstacles=(ball,)), dt_s=DT)
    stepped(step, Input(np.zeros(1)), 0.0, q, now_s())
    step.enable()
    start = q
    for u in (1.0, -1.0):
        q = start
        step.reset(q)
        stepped(step, Input(np.zeros(1)), 0.0, q, now_s())
        step.enable()
        for tick in range(200):
            if tick % 5 == 0:
                controller.matrix = harm.towards(q)[None] * 2.0
            before = measure.distances(q)
            q = q + stepped(step, Input(np.array([u])), 0.0, q, now_s()).command.velocity * DT
            assert (measure.distances(q) >= np.minimum(0.02, before) - 1e-8).all()
    assert measure.clearance(q) > 0.02
