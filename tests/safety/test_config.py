import math
from contextlib import suppress
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm.robots.kinematics.obstacles import Box, Capsule, HalfSpace, Sphere
from latentarm.robots.limits_file import parse_limits
from latentarm.safety.config import SafetyConfig, Workspace
from latentarm.safety.limits import STOPPED_WITHIN_S, Bounds
from latentarm.safety.obstacles import table

FIGURES = [field.name for field in fields(SafetyConfig) if field.name not in ("workspace", "obstacles")]


@pytest.mark.parametrize("name", FIGURES)
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, -1.0, 1e308, "0.5", None, True, [0.1]])
def test_what_is_no_limit_is_refused_by_name(name, bad):
    with pytest.raises(UserError, match=name):
        SafetyConfig(**{name: bad})


@pytest.mark.parametrize("name", [name for name in FIGURES if name not in ("dead_zone", "input_grace_s")])
def test_zero_is_no_limit(name):
    with pytest.raises(UserError, match=name):
        SafetyConfig(**{name: 0.0})


def test_defaults_are_the_ones_that_were_laid_down(arm):
    bounds = Bounds(SafetyConfig(), arm, 0.01)
    assert (bounds.speed == 0.5).all()
    assert bounds.config.link_speed == 0.25
    assert bounds.config.clearance == 0.02
    np.testing.assert_allclose(bounds.acceleration, 0.2 * arm.limits.acceleration)
    np.testing.assert_allclose(bounds.jerk, 0.2 * arm.limits.jerk)
    np.testing.assert_allclose(bounds.lower, arm.limits.lower + 0.1)
    np.testing.assert_allclose(bounds.upper, arm.limits.upper - 0.1)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"joint_speed": 2.4}, "joint_speed"),
        ({"link_speed": 1.8}, "link_speed"),
        ({"joint_margin": 1.0, "joint_speed": 0.1}, None),
        ({"stop_fraction": 0.3}, "stop_fraction"),
        ({"input_timeout_s": 0.1}, "input_timeout_s"),
        ({"input_timeout_s": 0.05, "input_grace_s": 0.11}, "input_grace_s"),
    ],
)
def test_limits_that_do_not_suit_the_robot_are_refused(arm, change, named):
    config = replace(SafetyConfig(), **change)
    if named is None:
        Bounds(config, arm, 0.01)
        return
    with pytest.raises(UserError, match=named):
        Bounds(config, arm, 0.01)


def test_a_margin_that_leaves_no_room_is_refused(arm):
    narrow = replace(arm, limits=replace(arm.limits, upper=arm.limits.lower + 0.15))
    with pytest.raises(UserError, match="a smaller margin_rad of it in a limits file"):
        Bounds(SafetyConfig(), narrow, 0.01)


def test_a_sliding_joint_keeps_a_margin_in_metres_and_a_limits_file_states_another(gantry):
    """As short as a segment of a telescope: 0.1 rad from both ends would leave nothing of it."""
    short = replace(gantry, limits=replace(gantry.limits, upper=np.array([0.5, 2.0, 0.13, 2.0])))
    bounds = Bounds(SafetyConfig(), short, 0.01)
    np.testing.assert_allclose(bounds.upper, [0.49, 1.9, 0.12, 1.9])
    stated = parse_limits({"joints": {"push": {"margin_m": 0.002}, "turn": {"margin_deg": 1.0}}}, "here")
    own = Bounds(SafetyConfig(), replace(short, stated_limits=stated), 0.01)
    np.testing.assert_allclose(own.upper, [0.49, 2.0 - np.deg2rad(1.0), 0.128, 1.9])
    np.testing.assert_allclose(own.lower, [-0.49, -2.0 + np.deg2rad(1.0), 0.002, -1.9])


@pytest.mark.parametrize("dt", [0.0, -0.01, math.nan, 1.0, 1e-6])
def test_absurd_periods_are_refused(arm, dt):
    with pytest.raises(UserError, match="period"):
        Bounds(SafetyConfig(), arm, dt)


@given(
    st.floats(0.01, 2.1),
    st.floats(0.1, 1.0),
    st.floats(0.005, 0.14),
    st.sampled_from([0.005, 0.01, 0.02, 0.05]),
)
def test_a_config_that_is_accepted_stops_in_time(arm, speed, stop, timeout, dt):
    bounds = None
    config = SafetyConfig(
        joint_speed=speed,
        stop_fraction=stop,
        input_timeout_s=timeout,
        acceleration_fraction=0.1,
        jerk_fraction=0.1,
        release_fraction=0.1,
    )
    with suppress(UserError):
        bounds = Bounds(config, arm, dt)
    if bounds is None:
        return
    # Ordinary motion never overshoots: at acceleration a it is a² / 2j short of the speed it is led to.
    for share in (0.0, 0.3, 1.0):
        acceleration = share * np.minimum(bounds.acceleration, np.sqrt(2.0 * bounds.jerk * speed))
        velocity = speed - acceleration**2 / (2.0 * bounds.jerk)
        worst = bounds.brake(velocity, acceleration).duration_s
        assert timeout + dt + worst <= STOPPED_WITHIN_S + 1e-9


@pytest.mark.parametrize("name", ["acceleration_fraction", "jerk_fraction", "release_fraction"])
def test_a_softer_stop_than_ordinary_motion_is_refused(name):
    with pytest.raises(UserError, match="stop_fraction"):
        SafetyConfig(**{name: 0.9})


@pytest.mark.parametrize(
    "bad",
    [
        lambda: Workspace(np.array([0.0, 0.0, 1.0]), np.array([1.0, 1.0, 1.0])),
        lambda: Workspace(np.array([0.0, 0.0, np.nan]), np.ones(3)),
        lambda: Workspace(np.zeros(2), np.ones(2)),
    ],
)
def test_a_workspace_that_is_no_box_is_refused(bad):
    with pytest.raises(UserError, match="workspace"):
        bad()


@pytest.mark.parametrize(
    "bad",
    [
        Sphere("thing", np.zeros(3), 0.0),
        Sphere("thing", np.zeros(3), math.nan),
        Sphere("thing", np.array([0.0, math.inf, 0.0]), 0.1),
        Sphere("thing", np.array([500.0, 0.0, 0.0]), 0.1),
        Capsule("thing", np.zeros(3), np.zeros(2), 0.1),
        HalfSpace("thing", np.zeros(3), np.array([0.0, 0.0, 2.0])),
        Box("thing", np.zeros(3), np.diag([1.0, 1.0, -1.0]), np.ones(3)),
        Box("thing", np.zeros(3), np.eye(3), np.array([1.0, 0.0, 1.0])),
    ],
)
def test_obstacles_that_are_none_are_refused_by_name(bad):
    with pytest.raises(UserError, match="thing"):
        SafetyConfig(obstacles=(bad,))


def test_a_table_is_a_plane_at_its_height():
    assert table(0.2).point[2] == 0.2
    with pytest.raises(UserError, match="table"):
        table(math.nan)


def test_a_sliding_joint_has_the_limit_of_links_or_its_own(arm):
    slide = np.zeros(7, dtype=bool)
    slide[2] = True
    sliding = replace(arm, chain=replace(arm.chain, slide=slide))
    np.testing.assert_allclose(
        Bounds(SafetyConfig(), sliding, 0.01).speed, [0.5, 0.5, 0.25, 0.5, 0.5, 0.5, 0.5]
    )
    slow = replace(sliding, limits=replace(arm.limits, velocity=np.full(7, 0.2)))
    np.testing.assert_allclose(
        Bounds(SafetyConfig(joint_speed=0.1), slow, 0.01).speed, [0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.1]
    )
