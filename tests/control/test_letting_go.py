"""Whoever lets go of the stick finds the arm at rest soon, without a jump, and may push again at once."""

import itertools

import numpy as np
import pytest

from latentarm.control.step import Step
from latentarm.core.types import Input
from latentarm.safety.config import SafetyConfig
from stepping import stepped

now_s = itertools.count(step=0.01).__next__
"""The loop's clock, one period later each time."""

NEUTRAL = Input(np.zeros(2))
MATRIX = np.stack([np.linspace(0.3, 0.5, 7), np.linspace(-0.1, 0.1, 7)])
DT = 0.01


@pytest.fixture
def going(arm, scripted):
    """A step whose arm goes as it is pushed, and where the arm is."""

    def going(push, **limits):
        step = Step(arm, scripted(MATRIX), SafetyConfig(**limits))
        step.reset(arm.home)
        stepped(step, NEUTRAL, 0.0, arm.home, now_s())
        assert step.enable() is None
        return step, commands(step, Input(np.array(push)), arm.home, 40)[1]

    return going


def commands(step, given, state, ticks):
    """Commands of so many ticks, (ticks, 7), rad/s, and where they have led."""
    sent = []
    for _ in range(ticks):
        sent.append(stepped(step, given, 0.0, state, now_s()).command.velocity)
        state = state + sent[-1] * DT
    return np.array(sent), state


@pytest.mark.parametrize("push", [(1.0, 0.0), (0.0, -1.0), (-0.7, 0.4), (0.31, -0.9)])
def test_the_arm_is_at_rest_as_soon_as_the_limits_let_it(going, arm, push):
    for fraction in (0.2, 0.8):
        step, state = going(push, release_fraction=fraction)
        sent, _ = commands(step, NEUTRAL, state, 60)
        speeds = np.abs(sent)
        most = fraction * arm.limits.acceleration
        lasts = (speeds[0] / most).max() + 2 * (most / (fraction * arm.limits.jerk)).max()
        # Exactly at rest, and not moving by ever less.
        assert not sent[int(np.ceil(lasts / DT)) + 1 :].any()
        assert step.at_rest
        assert (np.abs(np.diff(sent, axis=0)) <= most * DT + 1e-9).all()
        assert (np.diff(speeds, axis=0) <= 1e-12).all()
        assert step.stopped is None


def test_pushing_again_on_the_way_goes_on_without_a_stop(going, arm):
    step, state = going((1.0, 0.0), release_fraction=0.8)
    before, state = commands(step, NEUTRAL, state, 2)
    after, _ = commands(step, Input(np.array([1.0, 0.0])), state, 60)
    assert step.stopped is None
    assert np.abs(after[-1]).max() > np.abs(before[-1]).max() > 0.0
    most = 0.8 * arm.limits.acceleration * DT + 1e-9
    assert (np.abs(np.diff(np.concatenate([before, after]), axis=0)) <= most).all()
