"""From the last fresh input: zero command within 150 ms, at rest within 400 ms, ramped."""

import itertools

import numpy as np
import pytest

from latentarm.control.step import Step
from latentarm.core.types import Input
from latentarm.safety.config import SafetyConfig
from latentarm.safety.stack import SafetyStack
from stepping import stepped

now_s = itertools.count(step=0.01).__next__
"""The loop's clock, one period later each time."""


@pytest.mark.parametrize("dt", [0.005, 0.01, 0.02])
@pytest.mark.parametrize("seed", range(6))
def test_silence_stops_the_arm_in_time(arm, scripted, dt, seed):
    rng = np.random.default_rng(seed)
    matrix = rng.uniform(-1.0, 1.0, (2, 7)) * rng.choice([0.1, 1.0])
    step = Step(arm, scripted(matrix), SafetyConfig(), dt_s=dt)
    q = arm.home
    stepped(step, Input(np.zeros(2)), 0.0, q, 0.0)
    step.enable()
    push = Input(rng.choice([-1.0, 1.0], 2))
    now = 0.0
    for _ in range(int(rng.uniform(0.1, 1.5) / dt)):
        now += dt
        velocity = stepped(step, push, 0.0, q, now).command.velocity
        q = q + velocity * dt
    assert np.abs(velocity).max() > 0.005
    # The last input arrives somewhere between two ticks.
    fresh = now + rng.uniform(0.0, dt)
    zero_at = slow_at = None
    before = velocity
    for _ in range(int(0.5 / dt)):
        now += dt
        record = stepped(step, push, now - fresh, q, now)
        velocity = record.command.velocity
        q = q + velocity * dt
        assert (np.abs(velocity - before) <= step._stack.bounds.stop_acceleration * dt + 1e-9).all()
        before = velocity
        if zero_at is None and not velocity.any():
            zero_at = now
        if slow_at is None and np.abs(velocity).max() < 0.01:
            slow_at = now
    assert not velocity.any()
    assert zero_at - fresh <= 0.150 + 1e-9
    assert slow_at - fresh <= 0.400


def test_even_at_full_speed_of_every_joint(two_arms, scripted):
    """The planar arms reach the joint speed limit where the Panda's links are too fast for it."""
    config = SafetyConfig(link_speed=1.5, clearance=0.001)
    step = Step(two_arms, scripted(np.tile([0.5, -0.5], (2, 5))), config)
    q = two_arms.home
    stepped(step, Input(np.zeros(2)), 0.0, q, now_s())
    step.enable()
    for _ in range(30):
        velocity = stepped(step, Input(np.array([1.0, 0.0])), 0.0, q, now_s()).command.velocity
        q = q + velocity * 0.01
    assert np.abs(velocity).max() == pytest.approx(0.5, abs=0.01)
    ticks = 0
    while velocity.any():
        ticks += 1
        velocity = stepped(step, Input(np.array([1.0, 0.0])), ticks * 0.01, q, now_s()).command.velocity
        q = q + velocity * 0.01
    assert ticks * 0.01 <= 0.150


GRACE = SafetyConfig(input_timeout_s=0.05, input_grace_s=0.07)


def pushed(step, q, gap_s, after_s=0.5):
    """Velocities of an arm whose held stick falls silent for a while; and whether it is still enabled."""
    stepped(step, Input(np.zeros(2)), 0.0, q, 0.0)
    step.enable()
    velocities = []
    last_s = 0.0
    for tick in range(1, round((1.0 + gap_s + after_s) / 0.01)):
        now_s = tick * 0.01
        if not 1.0 < now_s < 1.0 + gap_s:
            last_s = now_s
        velocities.append(
            stepped(step, Input(np.array([1.0, 0.0])), now_s - last_s, q, now_s).command.velocity
        )
        q = q + velocities[-1] * 0.01
    return np.array(velocities), step.stopped


@pytest.mark.parametrize("gap_s", [0.02, 0.08, 0.12])
def test_a_moment_without_inputs_slows_the_arm_down_and_no_more(arm, scripted, gap_s):
    step = Step(arm, scripted(np.full((2, 7), 0.1)), GRACE)
    velocities, stopped = pushed(step, arm.home, gap_s)
    assert stopped is None
    np.testing.assert_allclose(velocities[-1], velocities[99], atol=0.01)
    assert (np.abs(np.diff(velocities, axis=0)) <= step._stack.bounds.stop_acceleration * 0.01 + 1e-9).all()
    if gap_s > 0.06:
        assert np.abs(velocities[100:]).max(axis=1).min() < 0.9 * np.abs(velocities[99]).max()


def test_a_longer_one_stops_it_as_soon_as_without_grace(arm, scripted):
    matrix = np.full((2, 7), 0.1)
    with_grace, stopped = pushed(Step(arm, scripted(matrix), GRACE), arm.home, 0.14)
    assert stopped is not None
    assert not with_grace[-1].any()
    without, _ = pushed(Step(arm, scripted(matrix), SafetyConfig(input_timeout_s=0.05)), arm.home, 0.14)
    np.testing.assert_array_equal(with_grace[:112], without[:112])


def test_an_arm_that_was_stopped_is_not_enabled_by_a_moment_without_inputs(arm, scripted):
    step = Step(arm, scripted(np.full((2, 7), 0.1)), GRACE)
    stepped(step, Input(np.zeros(2)), 0.0, arm.home, 0.0)
    step.enable()
    step.stop("Somebody pressed Stop.")
    stepped(step, Input(np.zeros(2)), 0.08, arm.home, 0.01)
    assert step.enable() is not None


@pytest.mark.parametrize("late", [2, 3, 5])
def test_a_stop_is_where_it_should_be_by_now_when_a_tick_is_late(arm, late):
    """The proof of a stop is one in time: a tick that comes late takes up the ramp where a prompt one is."""
    dt = 0.01

    def going():
        stack = SafetyStack(SafetyConfig(), arm, dt)
        for tick in range(40):
            stack.tick(tick * dt)
            stack.command(np.full(7, 0.3), arm.home, 0.0)
        stack.tick(0.4)
        return stack, stack.stop()

    prompt, first = going()
    for tick in range(1, late + 1):
        prompt.tick(0.4 + tick * dt)
        expected = prompt.stop()
    waiting, same = going()
    np.testing.assert_array_equal(first, same)
    waiting.tick(0.4 + late * dt)
    np.testing.assert_allclose(waiting.stop(), expected, atol=1e-12)
    assert np.abs(first).max() > np.abs(expected).max()
