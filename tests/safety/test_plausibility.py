"""Readings that cannot be true are found; those of a healthy arm never are."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from latentarm.control.step import STEADY_S, Step
from latentarm.core.types import Input
from latentarm.safety.config import SafetyConfig
from latentarm.safety.limits import Bounds
from latentarm.safety.plausibility import Plausibility
from stepping import stepped

NOISE_RAD = 1e-3
PERIODS_S = st.sampled_from([0.002, 0.005, 0.01, 0.02])
SEEDS = st.integers(0, 2**32 - 1)


def commands(rng, speed, ticks, dof=7):
    """(ticks, n), rad/s: any joint at its limit, at rest or anywhere between, without even a ramp."""
    found = np.empty((ticks, dof))
    tick = 0
    while tick < ticks:
        lasts = int(rng.integers(1, 120))
        kind = rng.integers(4, size=dof)
        wanted = np.choose(kind, [-speed, 0.0, speed, rng.uniform(-speed, speed, dof)])
        found[tick : tick + lasts] = wanted
        tick += lasts
    return found


def positions(velocity, dt_s, tau_s):
    """(T + 1, n), rad: where an arm is that follows commands (T, n) with a first-order lag."""
    share = 1.0 if tau_s == 0.0 else 1.0 - np.exp(-dt_s / tau_s)
    actual, found = np.zeros(velocity.shape[1]), [np.zeros(velocity.shape[1])]
    for wanted in velocity:
        actual = actual + share * (wanted - actual)
        found.append(found[-1] + actual * dt_s)
    return np.array(found)


def first_doubt(made, readings, velocity, dt_s, every=1):
    """When and why readings (T, n), new every so many ticks, are found implausible; None where never."""
    before = np.zeros(readings.shape[1])
    for tick, (reading, command) in enumerate(zip(readings, velocity, strict=True)):
        time_s = tick * dt_s
        stop = made.jump(reading, time_s) or made.follow(
            reading, before, time_s, new=tick % every == 0, driven=True
        )
        if stop is not None:
            assert stop.untrusted
            return time_s, stop.reason
        before = command
    return None


def make(arm, dt_s=0.01, **limits):
    bounds = Bounds(SafetyConfig(**limits), arm, dt_s)
    return Plausibility(bounds, arm), bounds


@given(SEEDS, PERIODS_S, st.floats(0.05, 0.8), st.floats(0.0, 0.03), st.booleans())
@settings(deadline=None, max_examples=60)
def test_a_healthy_arm_is_never_doubted(arm, seed, dt_s, speed, tau_s, jitters):
    """Readings one to five periods late, 1 mrad of noise, ordinary lag; motions at the limits."""
    rng = np.random.default_rng(seed)
    made, _ = make(arm, dt_s, joint_speed=speed, stop_fraction=1.0, input_timeout_s=0.005)
    velocity = commands(rng, speed, 300)
    true = positions(velocity, dt_s, tau_s)
    late = rng.integers(1, 6, len(velocity)) if jitters else np.full(len(velocity), rng.integers(1, 6))
    readings = true[np.maximum(np.arange(len(velocity)) - late, 0)]
    readings = readings + rng.normal(scale=NOISE_RAD, size=readings.shape)
    assert first_doubt(made, readings, velocity, dt_s) is None


@given(SEEDS, st.integers(1, 5), st.just(0.0) | st.floats(1e-6, 2e-3))
@settings(deadline=None, max_examples=40)
def test_readings_that_come_rarely_or_in_steps_are_healthy_too(arm, seed, every, step_rad):
    """A sensor slower than the loop, and an encoder with steps of up to 2 mrad."""
    rng = np.random.default_rng(seed)
    made, _ = make(arm)
    velocity = commands(rng, 0.5, 300)
    readings = positions(velocity, 0.01, 0.0)[(np.arange(300) // every) * every]
    if step_rad > 0.0:
        readings = np.round(readings / step_rad) * step_rad
    assert first_doubt(made, readings, velocity, 0.01, every) is None


@given(SEEDS, st.floats(0.0, 10.0))
@example(0, 10.0)
@settings(deadline=None, max_examples=40)
def test_exact_readings_of_an_arm_that_lags_are_healthy_too(arm, seed, late):
    """As a simulated arm without noise gives them; commands may stop and go on within the lag."""
    rng = np.random.default_rng(seed)
    made, bounds = make(arm)
    assert late * bounds.dt_s <= bounds.lag_s
    velocity = commands(rng, 0.5, 300)
    true = positions(velocity, 0.01, 0.0)
    taken, ticks = np.maximum(np.arange(300) - late, 0.0), np.arange(301)
    readings = np.array([np.interp(taken, ticks, joint) for joint in true.T]).T
    assert first_doubt(made, readings, velocity, 0.01) is None


@given(SEEDS, st.floats(0.1, 0.5))
@settings(deadline=None, max_examples=40)
def test_new_readings_that_repeat_on_the_way_are_noticed_sooner(arm, seed, speed):
    rng = np.random.default_rng(seed)
    made, bounds = make(arm)
    velocity = np.tile(rng.uniform(0.1, 1.0, 7) * speed * rng.choice([-1.0, 1.0], 7), (200, 1))
    velocity[:, 0] = speed
    readings = positions(velocity, 0.01, 0.0)[:-1]
    readings[60:] = readings[60]
    found_s, said = first_doubt(made, readings, velocity, 0.01)
    assert 0.6 < found_s <= 0.6 + bounds.config.freeze_margin / speed + 0.02
    assert "does not change" in said


@given(SEEDS, PERIODS_S, st.floats(0.1, 0.5), st.booleans())
@settings(deadline=None, max_examples=40)
def test_a_joint_that_is_held_is_noticed_as_soon_as_promised(arm, seed, dt_s, speed, frozen):
    rng = np.random.default_rng(seed)
    made, bounds = make(arm, dt_s, joint_speed=0.5)
    joint = int(rng.integers(7))
    velocity = np.tile(rng.uniform(-0.3, 0.3, 7), (int(2.5 / dt_s), 1))
    velocity[:, joint] = speed * rng.choice([-1.0, 1.0])
    readings = positions(velocity, dt_s, 0.0)[:-1]
    since = int(rng.uniform(0.0, 1.0) / dt_s)
    readings[since:, joint] = readings[since, joint]
    if not frozen:
        # A joint that is held, seen through a working encoder.
        readings = readings + rng.normal(scale=1e-5, size=readings.shape)
    config = bounds.config
    margin = config.freeze_margin if frozen else config.following_error
    found_s, said = first_doubt(made, readings, velocity, dt_s)
    # One span of the history, and rounding to periods, on top of what the limits say.
    promised_s = 1.125 * bounds.lag_s + margin / speed + 3 * dt_s
    assert since * dt_s < found_s <= since * dt_s + promised_s
    assert repr(arm.joint_names[joint]) in said
    assert ("does not change" in said) == frozen


@given(SEEDS, st.floats(0.15, 0.5))
@settings(deadline=None, max_examples=30)
def test_more_lag_than_allowed_is_noticed(arm, seed, speed):
    made, bounds = make(arm)
    velocity = np.full((300, 7), speed * np.random.default_rng(seed).choice([-1.0, 1.0]))
    too_late = int((1.2 * bounds.lag_s + bounds.config.following_error / speed) / 0.01) + 2
    true = positions(velocity, 0.01, 0.0)
    readings = true[np.maximum(np.arange(300) - too_late, 0)] + np.random.default_rng(seed).normal(
        scale=1e-5, size=(300, 7)
    )
    assert "follow" in first_doubt(made, readings, velocity, 0.01)[1]


@given(SEEDS, st.floats(0.1, 3.0))
@settings(deadline=None, max_examples=40)
def test_a_jump_is_noticed_at_once(arm, seed, size):
    rng = np.random.default_rng(seed)
    made, _ = make(arm)
    velocity = commands(rng, 0.5, 200)
    readings = positions(velocity, 0.01, 0.0)[:-1]
    joint, at = int(rng.integers(7)), int(rng.integers(1, 200))
    readings[at:, joint] += size * rng.choice([-1.0, 1.0])
    found_s, said = first_doubt(made, readings, velocity, 0.01)
    assert found_s == at * 0.01
    assert repr(arm.joint_names[joint]) in said
    assert "jumped" in said


def test_each_joint_may_move_as_far_as_it_can_in_the_time_and_no_farther(arm):
    """After a second in which nothing was read, the joint that moved most need not be the one that jumped."""
    slow, fast = int(arm.limits.velocity.argmin()), int(arm.limits.velocity.argmax())
    assert arm.limits.velocity[fast] > arm.limits.velocity[slow] + 0.3
    made, _ = make(arm)
    made.follow(np.zeros(7), np.zeros(7), 0.0, new=True, driven=False)
    q = np.zeros(7)
    q[fast] = arm.limits.velocity[fast]
    assert made.jump(q, 1.0) is None
    q[slow] = arm.limits.velocity[slow] + 0.2
    assert made.jump(q, 1.0).parameters["joint"] == arm.joint_names[slow]


def test_slow_drift_is_no_error_and_what_pushes_the_arm_away_is(arm):
    for drift, doubted in ((0.02, False), (0.3, True)):
        made, _ = make(arm)
        velocity = np.zeros((1000, 7))
        readings = np.tile(drift * 0.01 * np.arange(1000)[:, None], (1, 7))
        assert (first_doubt(made, readings, velocity, 0.01) is not None) == doubted


def test_an_arm_that_is_not_driven_may_be_moved_by_hand(arm):
    made, _ = make(arm)
    for tick in range(200):
        q = np.full(7, 0.01 * tick)
        assert made.jump(q, 0.01 * tick) is None
        assert made.follow(q, np.zeros(7), 0.01 * tick, new=True, driven=False) is None
    # From where it is now, it is expected to follow.
    assert made.follow(q, np.zeros(7), 2.0, new=True, driven=True) is None


def test_after_a_reset_nothing_of_before_is_held_against_the_arm(arm):
    """Readings of an arm that lags repeat at first, which is a fault only once it has moved for longer."""
    made, bounds = make(arm)
    velocity = np.full((30, 7), 0.5)
    true = positions(velocity, 0.01, 0.0)
    assert first_doubt(made, true[:-1], velocity, 0.01) is None
    made.reset()
    readings = true[np.maximum(np.arange(30) - round(bounds.lag_s / 0.01) + 1, 0)]
    for tick in range(30):
        assert made.follow(readings[tick], velocity[0], 0.01 * tick, new=True, driven=True) is None


def test_metres_where_a_joint_slides(gantry):
    made, _ = make(gantry, joint_speed=0.5)
    assert made.follow(gantry.home, np.zeros(4), 0.0, new=True, driven=True) is None
    assert " m in 10 ms" in made.jump(gantry.home + np.array([0.4, 0.0, 0.0, 0.0]), 0.01).reason


def test_a_window_that_is_shorter_than_the_lag_is_refused(arm):
    with pytest.raises(Exception, match="following_window_s"):
        make(arm, following_window_s=0.15)


class Rig:
    """A step that is driven with all its joints at 0.3 rad/s, on readings that `read` falsifies."""

    def __init__(self, arm, scripted):
        self.step = Step(arm, scripted(np.full((1, 7), 0.3)), SafetyConfig())
        self.q, self.tick = arm.home.copy(), 0
        self.read = lambda q: q
        self.record = None
        self.tick_with(0.0)
        assert self.step.enable() is None

    def tick_with(self, u, ticks=1):
        for _ in range(ticks):
            self.record = stepped(self.step, Input(np.full(1, u)), 0.0, self.read(self.q), 0.01 * self.tick)
            self.q = self.q + self.record.command.velocity * 0.01
            self.tick += 1
        return self.record


@pytest.fixture
def rig(arm, scripted):
    return Rig(arm, scripted)


def test_a_frozen_encoder_stops_the_arm_which_is_taken_to_have_moved(rig, arm):
    rig.tick_with(1.0, 60)
    frozen = rig.q.copy()
    rig.read = lambda q: frozen
    ticks = 0
    while rig.tick_with(1.0).command.stop is None:
        ticks += 1
        reading = rig.record.state
        # Up to the command of this tick the filters know where the arm is.
        known = rig.step._plausibility.estimate(reading) + rig.record.command.velocity * 0.01
        np.testing.assert_allclose(known, rig.q, atol=1e-9)
    assert ticks * 0.01 < 0.25
    assert rig.record.command.stop.untrusted
    assert "does not change" in rig.record.command.stop.reason


def test_an_arm_that_is_pushed_off_its_course_stops(rig):
    rig.tick_with(1.0, 60)
    pushed = np.zeros(7)

    def push(q):
        pushed[2] += 0.004
        return q + pushed

    rig.read = push
    rig.tick_with(1.0, 30)
    assert "'joint3' does not follow" in rig.record.command.stop.reason


def test_after_a_fault_that_has_gone_the_arm_can_be_enabled_and_driven(rig):
    rig.tick_with(1.0, 60)
    held = rig.q.copy()
    rig.read = lambda q: held
    rig.tick_with(1.0, 60)
    assert rig.step.stopped is not None
    rig.read = lambda q: q
    rig.q = held
    rig.tick_with(0.0, 30)
    assert rig.step.enable() is None
    rig.tick_with(1.0, 200)
    assert rig.step.stopped is None
    assert rig.record.command.velocity.any()


def test_letting_go_stopping_and_enabling_again_and_again_is_no_fault(rig):
    rng = np.random.default_rng(0)
    for _ in range(60):
        rig.tick_with(float(rng.choice([-1.0, 1.0])), int(rng.integers(1, 40)))
        if rng.integers(2):
            rig.step.stop("Stop was pressed.")
            rig.tick_with(0.0, int(rng.integers(1, 30)))
            assert rig.step.stopped.reason == "Stop was pressed."
            assert rig.step.enable() is None
        else:
            rig.tick_with(0.0, int(rng.integers(1, 30)))
        assert rig.step.stopped is None


@pytest.mark.parametrize("driving", [True, False])
def test_a_jump_is_said_and_must_be_over_before_the_arm_can_be_enabled(rig, driving):
    rig.tick_with(1.0, 30)
    if not driving:
        rig.step.stop("Stop was pressed.")
        rig.tick_with(0.0, 30)
    rig.read = lambda q: q + 1.5
    rig.tick_with(0.0)
    assert "jumped by 1.5 rad" in rig.record.command.stop.reason
    assert rig.record.command.stop.untrusted
    rig.tick_with(0.0, round(STEADY_S / 0.01) - 10)
    assert "jumped" in rig.step.enable().reason
    rig.tick_with(0.0, 10)
    # What happened is said until somebody has looked and presses Enable all the same.
    assert "jumped by 1.5 rad" in rig.step.stopped.reason
    assert rig.step.enable() is None


def test_what_cannot_be_read_is_recorded_as_such(rig):
    rig.tick_with(1.0, 30)
    rig.read = lambda q: np.full(7, np.nan)
    record = rig.tick_with(1.0)
    assert np.isnan(record.state).all()
    assert record.command.stop.untrusted
    assert record.command.velocity.any()


@pytest.mark.parametrize("leap_s", [0.0, -5.0, -1e-9, 0.03, 3600.0, float("nan"), float("inf")])
def test_not_one_moving_command_follows_a_clock_that_fails(rig, leap_s):
    rig.tick_with(1.0, 60)
    assert rig.record.command.velocity.any()
    time_s = 0.01 * (rig.tick - 1)
    record = stepped(rig.step, Input(np.ones(1)), 0.0, rig.q, time_s + leap_s)
    assert not record.command.velocity.any()
    assert "clock" in record.command.stop.reason
    for tick in range(30):
        later_s = time_s + (leap_s if np.isfinite(leap_s) else 0.0) + 0.01 * (tick + 1)
        record = stepped(rig.step, Input(np.ones(1)), 0.0, rig.q, later_s)
        assert not record.command.velocity.any()


def test_a_command_counts_for_no_longer_than_it_lasts(arm):
    """After a late tick the arm has stopped by itself, and is where its last command left it."""
    made, bounds = make(arm)
    velocity, q = np.full(7, 0.4), np.zeros(7)
    made.follow(q, np.zeros(7), 0.0, new=True, driven=True)
    q = q + velocity * bounds.hold_s
    time_s = 1.0
    assert made.follow(q, velocity, time_s, new=True, driven=True) is None
    for _ in range(100):
        time_s += 0.01
        assert made.follow(q + 1e-6 * time_s, np.zeros(7), time_s, new=True, driven=True) is None
