"""No input of any kind, no failing controller and no odd reading gets an unsafe command out of the step."""

import dataclasses
import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.control.step import Step
from latentarm.core.types import Input
from latentarm.robots.kinematics.obstacles import Sphere
from latentarm.safety.config import SafetyConfig, Workspace
from latentarm.safety.obstacles import table
from stepping import stepped

now_s = itertools.count(step=0.01).__next__
"""The loop's clock, one period later each time."""

DT = 0.01
OBSTACLES = (table(0.0), Sphere("ball", np.array([0.5, 0.2, 0.3]), 0.1))
WORKSPACE = Workspace(np.array([-0.9, -0.9, 0.0]), np.array([0.9, 0.9, 1.3]))

any_float = st.floats(width=64)
good_input = arrays(np.float64, 2, elements=st.floats(-1.0, 1.0))
any_input = (
    good_input
    | arrays(np.float64, 2, elements=any_float | st.sampled_from([1e308, -1e308, 5e-324, np.nan, np.inf]))
    | arrays(np.float64, st.sampled_from([(), (0,), (1,), (3,), (2, 2)]), elements=any_float)
    | arrays(np.float32, 2, elements=st.floats(width=32))
    | arrays(np.int64, 2)
    | arrays(np.complex128, 2)
    | arrays(np.bool_, 2)
    | st.sampled_from(
        [np.array(["left", "up"]), np.array([None, 1.0]), [[1.0], [1.0, 2.0]], None, "left", 3.0]
    )
)
good_age = st.floats(0.0, 0.04)
any_age = good_age | any_float
any_action = (
    st.none()
    | arrays(np.float64, 7, elements=any_float)
    | arrays(np.float64, st.sampled_from([(), (6,), (8,), (7, 7)]), elements=any_float)
    | st.sampled_from(
        [
            ValueError("broken"),
            ZeroDivisionError(),
            MemoryError(),
            [1.0, [2.0]],
            "fast",
            np.ones(7, dtype=complex),
        ]
    )
)


@st.composite
def tick(draw):
    usual = draw(st.integers(0, 3)) > 0
    return (
        draw(good_input if usual else any_input),
        draw(good_age if usual else any_age),
        None if draw(st.integers(0, 3)) else draw(any_action),
        draw(st.booleans()),
        draw(st.integers(1, 12)),
    )


def limits_kept(step_bounds, before, velocity, before_that):
    """Speed, acceleration and jerk of a command against those before it."""
    bounds = step_bounds
    assert velocity.shape == (bounds.dof,)
    assert np.isfinite(velocity).all()
    assert (np.abs(velocity) <= bounds.speed + 1e-9).all()
    change = velocity - before
    assert (np.abs(change) <= bounds.stop_acceleration * bounds.dt_s + 1e-9).all()
    assert (np.abs(change - (before - before_that)) <= bounds.stop_jerk * bounds.dt_s**2 + 1e-9).all()
    # Speeding up is always gentle; only a stop may use more.
    faster = (np.abs(velocity) > np.abs(before)) & (velocity * before >= 0.0)
    assert (np.abs(change)[faster] <= bounds.acceleration[faster] * bounds.dt_s + 1e-9).all()


def drive(robot, scripted, oracle, state, matrix, ticks):
    """Run ticks of (input, age, answer, switch, repeats); after every stop the person enables again."""
    controller = scripted(matrix, modes=("one", "two"))
    step = Step(robot, controller, SafetyConfig(obstacles=OBSTACLES, workspace=WORKSPACE), dt_s=DT)
    step.reset(state)
    bounds = step._stack.bounds
    measure = oracle(robot, OBSTACLES)
    q, before, before_that = state, np.zeros(7), np.zeros(7)
    distances = measure.distances(q)
    for u, age, answer, switch, repeats in ticks:
        if step.stopped is not None:
            given = [(Input(np.zeros(2)), 0.0, None)] + [(Input(u, switch), age, answer)] * repeats
        else:
            given = [(Input(u, switch), age, answer)] * repeats
        for index, (one, its_age, its_answer) in enumerate(given):
            controller.answer = None if its_answer is None else _answering(its_answer)
            record = stepped(step, one, its_age, q, now_s())
            if index == 0 and len(given) > repeats:
                step.enable()
            velocity = record.command.velocity
            limits_kept(bounds, before, velocity, before_that)
            assert record.input.shape == (2,)
            assert (np.abs(record.input) <= 1.0).all()
            assert measure.link_speed(q, velocity) <= 0.25 + 1e-6
            before, before_that = velocity, before
            q = q + velocity * DT
            assert (q <= np.maximum(bounds.upper, state) + 1e-9).all()
            assert (q >= np.minimum(bounds.lower, state) - 1e-9).all()
            now = measure.distances(q)
            assert (now >= np.minimum(0.02, distances) - 1e-6).all()
            distances = now


def _answering(answer):
    def act(context):
        if isinstance(answer, Exception):
            raise answer
        return answer

    return act


@given(
    st.integers(0, 2**32 - 1),
    arrays(np.float64, (2, 7), elements=st.floats(-1.0, 1.0) | any_float),
    st.lists(tick(), min_size=1, max_size=8),
)
def test_no_input_gets_an_unsafe_command_out(arm, scripted, oracle, seed, matrix, ticks):
    rng = np.random.default_rng(seed)
    state = rng.uniform(arm.limits.lower, arm.limits.upper)
    drive(arm, scripted, oracle, state, matrix, ticks)


@given(
    st.lists(
        arrays(np.float64, 7, elements=any_float) | arrays(np.float64, 6) | st.just(np.array(["a"] * 7)),
        min_size=1,
    )
)
def test_no_reading_of_the_joints_gets_an_unsafe_command_out(arm, scripted, readings):
    step = Step(arm, scripted(np.full((2, 7), 0.4)), SafetyConfig(obstacles=OBSTACLES), dt_s=DT)
    step.reset(arm.home)
    stepped(step, Input(np.zeros(2)), 0.0, arm.home, now_s())
    step.enable()
    before = before_that = np.zeros(7)
    for reading in [arm.home] * 10 + readings + readings:
        velocity = stepped(step, Input(np.ones(2)), 0.0, reading, now_s()).command.velocity
        limits_kept(step._stack.bounds, before, velocity, before_that)
        before, before_that = velocity, before
    # Readings far out of reach are no reason to rush either.
    assert np.abs(velocity).max() <= 0.5


@pytest.mark.parametrize(
    "u",
    [
        np.array([np.nan, 0.0]),
        np.array([1e308, 0.0]),
        np.array([0.0, np.inf]),
        np.array([0.0, -2.1]),
        np.zeros(3),
        "up",
    ],
)
def test_an_unusable_input_stops_with_a_reason(arm, scripted, u):
    step = Step(arm, scripted(np.full((2, 7), 0.4)), SafetyConfig())
    step.reset(arm.home)
    stepped(step, Input(np.zeros(2)), 0.0, arm.home, now_s())
    assert step.enable() is None
    record = stepped(step, Input(u), 0.0, arm.home, now_s())
    assert record.command.stop is not None
    assert "input" in record.command.stop.reason
    assert not record.input.any()


def test_a_little_past_the_edge_is_cut_off(arm, scripted):
    step = Step(arm, scripted(np.full((2, 7), 0.1)), SafetyConfig())
    step.reset(arm.home)
    stepped(step, Input(np.zeros(2)), 0.0, arm.home, now_s())
    step.enable()
    record = stepped(step, Input(np.array([1.05, -1.2])), 0.0, arm.home, now_s())
    assert record.command.stop is None
    np.testing.assert_array_equal(record.input, [1.0, -1.0])


def test_records_are_frozen_and_their_states_are_copies(arm, scripted):
    step = Step(arm, scripted(np.full((2, 7), 0.1)), SafetyConfig())
    state = arm.home.copy()
    record = stepped(step, Input(np.zeros(2)), 0.0, state, now_s())
    state += 1.0
    np.testing.assert_array_equal(record.state, arm.home)
    with pytest.raises(dataclasses.FrozenInstanceError):
        record.alpha = 1.0
