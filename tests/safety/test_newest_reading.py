"""Readings that are too old, out of order or without a time stop the arm."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.control.step import Step
from latentarm.core.types import GripperReading, Input, Reading
from latentarm.safety.config import SafetyConfig
from latentarm.safety.limits import STOPPED_WITHIN_S, Bounds
from latentarm.safety.newest_reading import NewestReading

PUSH, NEUTRAL = Input(np.array([1.0, 0.0])), Input(np.zeros(2))


@pytest.fixture
def step(arm, scripted):
    """Enabled at 0.01 s, with readings 0 and 1."""
    made = Step(arm, scripted(np.full((2, 7), 0.2)), SafetyConfig())
    made.reset(arm.home)
    for tick in range(2):
        made(NEUTRAL, 0.0, reading(arm, 0.01 * tick, tick), 0.01 * tick)
    assert made.enable() is None
    return made


def reading(arm, time_s, sequence):
    return Reading(arm.home, np.zeros(7), time_s, sequence, GripperReading(arm.gripper.width_m))


def test_a_reading_may_be_five_periods_old_and_no_older(step, arm):
    old = reading(arm, 0.02, 2)
    for tick in range(2, 8):
        assert step(PUSH, 0.0, old, 0.01 * tick).command.stop is None
    stopped = step(PUSH, 0.0, old, 0.08)
    assert stopped.command.stop.reason == (
        "The arm's newest reading is 60 ms old: check the connection to the arm."
    )
    assert stopped.command.stop.untrusted
    # Nobody knows where the joints are now, and nothing that is recorded says that it did.
    assert np.isnan(stopped.state).all()


@pytest.mark.parametrize(
    ("time_s", "sequence", "why"),
    [
        (0.02, 0, "wrong order"),
        (0.05, 2, "future"),
        (np.nan, 2, "no time"),
        (-np.inf, 2, "no time"),
        (None, 2, "cannot be used"),
        (0.02, "two", "cannot be used"),
        (0.02, np.nan, "cannot be used"),
    ],
)
def test_a_driver_that_does_not_keep_time_or_count_stops_the_arm(step, arm, time_s, sequence, why):
    record = step(PUSH, 0.0, reading(arm, time_s, sequence), 0.02)
    assert why in record.command.stop.reason
    assert np.isfinite(record.command.velocity).all()


@pytest.mark.parametrize("thing", [None, 3.0, np.zeros(7)])
def test_what_is_no_reading_stops_the_arm(step, thing):
    assert "cannot be used" in step(PUSH, 0.0, thing, 0.02).command.stop.reason


def test_a_reading_may_be_taken_after_the_tick_has_begun(step, arm):
    assert step(PUSH, 0.0, reading(arm, 0.029, 2), 0.02).command.stop is None


def test_after_a_reset_a_driver_may_count_from_the_start(step, arm):
    step.reset(arm.home)
    assert "not enabled" in step(NEUTRAL, 0.0, reading(arm, 0.5, 0), 0.5).command.stop.reason


def test_a_reading_is_new_once():
    newest = NewestReading(0.05, 0.025)
    said = []
    for sequence in (4, 4, 5, 5, 5):
        assert newest.refusal(Reading(np.zeros(1), np.zeros(1), 0.0, sequence), 0.01) is None
        said.append(newest.new)
    assert said == [True, False, True, False, False]


@given(st.floats(0.001, 0.05), st.floats(1.0, 50.0), st.floats(0.05, 0.3))
def test_the_stop_after_the_oldest_reading_ends_in_time(arm, dt_s, reading_periods, joint_speed):
    config = SafetyConfig(
        joint_speed=joint_speed,
        input_timeout_s=0.001,
        reading_periods=reading_periods,
        following_window_s=2.0,
    )
    bounds = Bounds(config, arm, dt_s)
    assert bounds.reading_timeout_s + dt_s + bounds.stop_s <= STOPPED_WITHIN_S + 1e-12
    assert bounds.reading_timeout_s <= reading_periods * dt_s
    assert bounds.reading_timeout_s > 0.0
