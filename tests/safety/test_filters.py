"""Each filter alone, with any float."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from latentarm.core.types import Stop
from latentarm.robots.kinematics.obstacles import Sphere
from latentarm.safety.barriers import past_barriers
from latentarm.safety.body import Body, Placement
from latentarm.safety.config import SafetyConfig, Workspace
from latentarm.safety.filter import (
    Finite,
    GuardedArm,
    JointVelocity,
    LinkSpeed,
    Situation,
)
from latentarm.safety.halfspaces import slide
from latentarm.safety.input_timeout import InputTimeout
from latentarm.safety.limits import Bounds
from latentarm.safety.obstacles import table
from latentarm.safety.ramp import Ramp

any_velocity = arrays(np.float64, 7, elements=st.floats(width=64))
finite_velocity = arrays(
    np.float64, 7, elements=st.floats(allow_nan=False, allow_infinity=False) | st.floats(-2.0, 2.0)
)
asked_velocity = arrays(np.float64, 7, elements=st.floats(-0.5, 0.5))
states = st.integers(0, 2**32 - 1)


@pytest.fixture(scope="module")
def surroundings(arm):
    config = SafetyConfig(
        obstacles=(table(0.0), Sphere("ball", np.array([0.5, 0.2, 0.4]), 0.1)),
        workspace=Workspace(np.array([-0.6, -0.6, 0.0]), np.array([0.6, 0.6, 0.9])),
    )
    return GuardedArm(Bounds(config, arm, 0.01), Body(arm))


@pytest.fixture(scope="module")
def alone(arm):
    arm = replace(arm, self_pairs=arm.self_pairs[:0])
    return GuardedArm(Bounds(SafetyConfig(), arm, 0.01), Body(arm))


def situation(surroundings, seed=0, age=0.0, state=None):
    limits = surroundings.body.robot.limits
    rng = np.random.default_rng(seed)
    q = rng.uniform(limits.lower, limits.upper) if state is None else state
    return Situation(surroundings, q, np.zeros(7), np.zeros(7), age)


def way_of_the_tool(surroundings, q):
    """The squares of its twist, of which 30 cm count as much as 1 rad, far above those of the joints."""
    tool = surroundings.body.robot.chain.jacobian(q) / np.repeat([[0.3], [1.0]], 3, axis=0)
    return np.eye(7) + 1000.0 * tool.T @ tool


@given(any_velocity)
def test_finite_lets_only_numbers_through(surroundings, velocity):
    result = Finite().apply(velocity, situation(surroundings, state=np.zeros(7)))
    assert (result is velocity) if np.isfinite(velocity).all() else isinstance(result, Stop)


@pytest.mark.parametrize("shape", [(), (6,), (8,), (7, 1), (0,)])
def test_finite_wants_one_number_for_each_joint(surroundings, shape):
    assert isinstance(Finite().apply(np.zeros(shape), situation(surroundings)), Stop)


@given(st.floats(width=64))
def test_freshness_stops_unless_the_age_is_known_and_small(surroundings, age):
    velocity = np.ones(7)
    result = InputTimeout().apply(velocity, situation(surroundings, state=np.zeros(7), age=age))
    if 0.0 <= age <= surroundings.bounds.config.input_timeout_s:
        assert result is velocity
    else:
        assert isinstance(result, Stop)


@given(finite_velocity)
def test_joint_velocity_keeps_the_limit_and_the_direction(surroundings, velocity):
    result = JointVelocity().apply(velocity, situation(surroundings, state=np.zeros(7)))
    assert np.abs(result).max() <= 0.5 * (1 + 1e-12)
    fastest = np.abs(velocity).max()
    if fastest > 0.5:
        np.testing.assert_allclose(result, velocity / fastest * 0.5, rtol=1e-9, atol=1e-300)
    else:
        assert result is velocity


@given(asked_velocity, arrays(np.float64, 7, elements=st.floats(-4.0, 4.0)))
def test_a_joint_stops_at_its_limit_and_the_others_keep_the_tool_on_its_way(alone, velocity, state):
    bounds, here, limited_by = alone.bounds, situation(alone, state=state), []
    result = past_barriers(velocity, here, limited_by)
    assert (result is velocity) == (limited_by == []) == (result == velocity).all()
    assert (result[state >= bounds.upper] <= 0.0).all()
    assert (result[state <= bounds.lower] >= 0.0).all()
    room = np.where(result > 0, bounds.upper - state, state - bounds.lower)
    assert (np.abs(result) <= bounds.damping_per_s * np.maximum(room, 0.0) + 1e-12).all()
    # Where all are slow enough already, nothing changes.
    room = np.where(velocity > 0, bounds.upper - state, state - bounds.lower)
    free = np.abs(velocity) <= bounds.damping_per_s * (room - 0.003)
    assert result is velocity or not free.all()
    # Slowing only the joints that are too fast would lead the tool farther off.
    slowed = np.clip(velocity, *((bounds.positions - state) * bounds.damping_per_s + [[0.003], [-0.003]]))
    off, farther = result - velocity, np.where(slowed * velocity > 0.0, slowed, 0.0) - velocity
    metric = way_of_the_tool(alone, state)
    assert off @ metric @ off <= farther @ metric @ farther + 1e-6


@given(asked_velocity, states)
def test_link_speed_slows_every_point_and_keeps_the_direction(surroundings, oracle, velocity, seed):
    here = situation(surroundings, seed)
    drift = np.random.default_rng(seed).normal(size=7) * 0.01
    surroundings.reference = Placement(surroundings.body, here.state + drift)
    result = LinkSpeed().apply(velocity, here)
    assert oracle(surroundings.body.robot).link_speed(here.state, result) <= 0.25 + 1e-6
    assert result @ velocity >= 0.0
    size = velocity @ velocity
    if size > 1e-12:
        np.testing.assert_allclose(result, velocity * (result @ velocity / size), atol=1e-9)


@given(asked_velocity, states)
def test_clearance_damps_every_approach(surroundings, oracle, velocity, seed):
    here = situation(surroundings, seed)
    drift = np.random.default_rng(seed).normal(size=7) * 0.007
    surroundings.proximity.measured(Placement(surroundings.body, here.state + drift), np.abs(velocity))
    limited_by = []
    result = past_barriers(velocity, here, limited_by)
    if "joint position" not in limited_by:  # there other joints do the part of the one at its limit
        assert result @ result <= velocity @ velocity + 1e-12
        assert result @ velocity >= -1e-12
    measure = oracle(surroundings.body.robot, surroundings.bounds.config.obstacles)
    before = measure.distances(here.state)
    rate = (measure.distances(here.state + 1e-6 * result) - before) / 1e-6
    # Far pairs are bounded by the speed of links, which is not this filter's business.
    near = before < surroundings.bounds.nearest_m + 0.25 / surroundings.bounds.damping_per_s
    floor = -surroundings.bounds.damping_per_s * np.maximum(before - 0.02, 0.0)
    # Far from a limit the directions may be a few ticks old.
    assert (rate[near] >= floor[near] - 0.02 * (before[near] > 0.021) - 1e-4).all()


@given(asked_velocity, states)
def test_workspace_damps_every_way_out(surroundings, oracle, velocity, seed):
    here = situation(surroundings, seed)
    limited_by = []
    result = past_barriers(velocity, here, limited_by)
    assert result @ result <= velocity @ velocity + 1e-12 or "joint position" in limited_by
    workspace = surroundings.bounds.config.workspace
    points = here.placement.points
    moved = np.tensordot(result, here.placement.jacobian[:, :3], axes=1).T
    damping = surroundings.bounds.damping_per_s
    assert (moved >= -damping * np.maximum(points - workspace.lower, 0.0) - 1e-6)[
        points < workspace.lower + 0.08
    ].all()
    assert (moved <= damping * np.maximum(workspace.upper - points, 0.0) + 1e-6)[
        points > workspace.upper - 0.08
    ].all()


@given(st.lists(asked_velocity, min_size=1, max_size=20), st.integers(1, 15))
def test_ramp_keeps_acceleration_and_jerk_and_arrives(surroundings, wanted, ticks):
    bounds, dt = surroundings.bounds, 0.01
    ramp = Ramp(bounds.dt_s, bounds.acceleration, bounds.jerk)
    velocity, acceleration = np.zeros(7), np.zeros(7)
    path = [velocity, velocity]
    for target in [*wanted, *[wanted[-1]] * 120]:
        for _ in range(ticks if target is not wanted[-1] else 1):
            velocity, acceleration = ramp.ramped(target, velocity, acceleration)
            path.append(velocity)
    steps = np.diff(path, axis=0)
    assert (np.abs(steps) <= bounds.acceleration * dt + 1e-9).all()
    assert (np.abs(np.diff(steps, axis=0)) <= bounds.jerk * dt**2 + 1e-9).all()
    assert np.abs(path).max() <= 0.5 + 1e-9
    np.testing.assert_allclose(velocity, wanted[-1], atol=1e-9)


def test_ramp_alone_is_a_filter(surroundings):
    here = situation(surroundings)
    ramped = Ramp(0.01, surroundings.bounds.acceleration, surroundings.bounds.jerk).apply(
        np.full(7, 0.3), here
    )
    assert (ramped > 0.0).all()
    assert (ramped <= surroundings.bounds.acceleration * 0.01 + 1e-12).all()


@given(st.integers(0, 2**32 - 1))
def test_sliding_never_goes_faster_nor_against_what_was_asked(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 12))
    rows = rng.normal(size=(count, 7)) * rng.choice([0.0, 1e-9, 1.0], size=(count, 1))
    floor = -rng.choice([0.0, 0.01, 1.0], size=count)
    velocity = rng.normal(size=7) * rng.choice([1e-6, 1.0])
    passed = (floor == 0.0) & (rng.uniform(size=count) < 0.3)
    lowest, highest = -rng.choice([0.0, 0.1, 10.0], size=(2, 7)) * [[1.0], [-1.0]]
    held = rng.normal(size=(7, 6)) * rng.choice([0.0, 10.0])
    metric = np.eye(7) + held @ held.T
    metric /= np.linalg.norm(metric, 2)
    result, acting = slide(velocity, (lowest, highest), rows, floor, passed, metric)
    # The solver rounds; what that is too much for, the guard stops.
    rounding = 1e-8 * np.linalg.norm(velocity) + 1e-6 * held.any()
    assert (rows @ result >= floor - rounding * np.linalg.norm(rows, axis=1)).all()
    assert (result >= lowest).all()
    assert (result <= highest).all()
    if acting[7:].any() or not held.any():  # limits alone clip
        assert result @ metric @ result <= velocity @ metric @ velocity * (1 + 1e-9)
        assert result @ metric @ velocity >= -1e-10
    assert (result is velocity) == (not acting.any())
    if (
        not passed.any()
        and (rows @ velocity >= floor).all()
        and (np.clip(velocity, lowest, highest) == velocity).all()
    ):
        assert result is velocity
