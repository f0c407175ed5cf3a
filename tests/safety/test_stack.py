"""What the filters of the stack do that the guard after them would not do, or not as well."""

import numpy as np
import pytest

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.core.types import Context
from latentarm.robots.kinematics.obstacles import HalfSpace
from latentarm.safety.config import SafetyConfig
from latentarm.safety.stack import SafetyStack

DT = 0.01


def asked(stack, wanted, q, ticks, pace=1.0):
    """Commands (ticks, n), rad/s, while the same is asked all the time, and where they have led."""
    sent = []
    for _ in range(ticks):
        sent.append(stack.command(wanted, q, 0.0, pace).velocity)
        q = q + DT * sent[-1]
    return np.array(sent), q


@pytest.mark.parametrize("age_s", [0.041, np.inf, -0.01, np.nan])
def test_it_stops_for_old_inputs_by_itself(arm, age_s):
    stack = SafetyStack(SafetyConfig(), arm, DT)
    asked(stack, np.full(7, 0.2), arm.home, 30)
    passed = stack.command(np.full(7, 0.2), arm.home, age_s)
    assert passed.stop is not None
    assert np.abs(passed.velocity).max() < 0.2


@pytest.mark.parametrize("seed", [3, 14, 20, 33])
def test_sliding_along_a_thing_takes_no_joint_past_its_speed(arm, seed):
    """All joints are asked for their full speed, obliquely at a plane just beyond the tool."""
    rng = np.random.default_rng(seed)
    wanted = rng.choice([-0.1, 0.1], 7)
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    plane = HalfSpace("plane", arm.chain.forward(arm.home).position - 0.035 * normal, normal)
    stack = SafetyStack(SafetyConfig(joint_speed=0.1, obstacles=(plane,)), arm, DT)
    sent = np.array([stack.command(wanted, arm.home, 0.0).velocity for _ in range(60)])
    assert np.abs(sent[-1]).max() > 0.05
    assert np.abs(sent).max() <= 0.1 + 1e-9


def test_at_the_limit_of_a_joint_the_tool_keeps_its_way(arm):
    """Down for 6 s, past where one joint of seven can go no farther."""
    control, stack, states = EndEffectorController(arm), SafetyStack(SafetyConfig(), arm, DT), [arm.home]
    limited = 0
    for _ in range(600):
        q = states[-1]
        passed = stack.command(control.action(np.array([-1.0, 0.0]), Context(q, np.zeros(0)), 1), q, 0.0)
        limited += "joint position" in passed.limited_by
        states.append(q + DT * passed.velocity)
    moved = arm.chain.forward(np.array(states)).position - arm.chain.forward(arm.home).position
    assert limited > 100
    assert moved[-1, 2] < -0.75
    assert np.linalg.norm(moved[:, :2], axis=1).max() < 0.015  # 31 mm where only that joint is slowed


@pytest.mark.parametrize("seed", [1, 5])
def test_links_at_their_limit_go_another_way_as_soon_as_they_are_asked(arm, oracle, seed):
    one_way, another = np.random.default_rng(seed).normal(size=(2, 7))
    stack = SafetyStack(SafetyConfig(), arm, DT)
    before, q = asked(stack, one_way, arm.home, 40)
    assert oracle(arm).link_speed(q, before[-1]) > 0.2
    after, _ = asked(stack, another, q, 20)
    turned = after[-1] @ another / np.linalg.norm(after[-1]) / np.linalg.norm(another)
    assert turned > 0.9


def test_pace_zero_is_as_soon_at_rest_as_letting_go(arm):
    def ticks_to_rest(wanted, pace):
        stack = SafetyStack(SafetyConfig(acceleration_fraction=0.05, release_fraction=0.8), arm, DT)
        _, q = asked(stack, np.full(7, 0.1), arm.home, 100)
        return np.count_nonzero(asked(stack, wanted, q, 100, pace)[0].any(axis=1))

    let_go = ticks_to_rest(np.zeros(7), 1.0)
    assert 0 < let_go < 10
    assert ticks_to_rest(np.full(7, 0.1), 0.0) == let_go
