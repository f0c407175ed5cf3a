"""Controllers, observers, interfaces and loops that behave badly: none gets the arm to move unsafely."""

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import linprog

from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.input_port import InputPort, InputSource
from latentarm.control.loop import ControlLoop
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import Input, Stop
from latentarm.robots.kinematics.obstacles import Sphere
from latentarm.safety.config import SafetyConfig, Workspace
from latentarm.safety.limits import Bounds
from latentarm.safety.ramp import Ramp
from stepping import stepped

now_s = itertools.count(step=0.01).__next__
"""The loop's clock, one period later each time."""

DT = 0.01
NEUTRAL, PUSH = Input(np.zeros(1)), Input(np.ones(1))


@pytest.fixture
def driven(arm, scripted):
    controller = scripted(np.full((1, 7), 0.3))
    step = Step(arm, controller, SafetyConfig(), dt_s=DT)
    stepped(step, NEUTRAL, 0.0, arm.home, now_s())
    assert step.enable() is None
    return step, controller


def test_a_controller_cannot_move_what_the_filters_measure_from(driven, arm):
    step, controller = driven

    def lie(context):
        context.state[:] = arm.home
        return np.eye(7)[3]

    controller.answer = lie
    q = arm.home
    for _ in range(600):
        q = q + stepped(step, PUSH, 0.0, q, now_s()).command.velocity * DT
    assert (q <= arm.limits.upper).all()


@pytest.mark.parametrize("name", ["state", "input", "latent", "action_human", "action_assist", "velocity"])
def test_whoever_sees_a_record_cannot_move_the_arm_with_it(driven, arm, name):
    step, _ = driven
    q = arm.home
    for _ in range(100):
        record = stepped(step, NEUTRAL, 0.0, q, now_s())
        q = q + record.command.velocity * DT
        with pytest.raises(ValueError, match="read-only"):
            (record.command.velocity if name == "velocity" else getattr(record, name))[...] = 0.4
    np.testing.assert_array_equal(q, arm.home)


class Raises:
    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("no")


class WordlessError(Exception):
    def __str__(self):
        raise RuntimeError("no words")


@pytest.mark.parametrize(
    "given", [None, Input(Raises()), Input([[1], [1, 2]]), Input(np.ones(1), np.ones(2))]
)
def test_inputs_that_cannot_even_be_read_stop_the_arm(driven, arm, given):
    step, _ = driven
    assert stepped(step, PUSH, 0.0, arm.home, now_s()).command.stop is None
    assert stepped(step, given, 0.0, arm.home, now_s()).command.stop is not None


@pytest.mark.parametrize("age", [None, "0"])
def test_an_age_that_is_none_stops_the_arm(driven, arm, age):
    step, _ = driven
    assert stepped(step, PUSH, age, arm.home, now_s()).command.stop is not None


@pytest.mark.parametrize("state", [None, Raises(), [[1], [1, 2]]])
def test_a_state_that_is_none_stops_the_arm(driven, state):
    step, _ = driven
    assert stepped(step, PUSH, 0.0, state, now_s()).command.stop is not None


def test_an_error_without_words_stops_the_arm(driven, arm):
    step, controller = driven

    def fail(context):
        raise WordlessError

    controller.answer = fail
    assert "WordlessError" in stepped(step, PUSH, 0.0, arm.home, now_s()).command.stop.reason


def test_a_stop_that_was_harder_than_ordinary_motion_can_be_taken_up_again(two_arms):
    bounds = Bounds(SafetyConfig(), two_arms, DT)
    ramp = Ramp(DT, bounds.acceleration, bounds.jerk)
    sign = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, 1.0, 1.0, -1.0, -1.0, -1.0])
    # Figures at which the generator of ramps raises an error of its own.
    found = ramp.ramped(0.2981398858302408 * sign, 0.2945228216277188 * sign, -2.400000000000002 * sign)
    assert isinstance(found, Stop)


def test_a_stop_takes_as_long_when_ticks_come_late(driven, arm):
    step, _ = driven
    q, time_s, stopped_s = arm.home, 0.0, None
    for tick in range(60):
        time_s += 2 * DT
        if tick == 40:
            stopped_s = time_s
            step.stop("Stop.")
        q = q + stepped(step, PUSH, 0.0, q, time_s).command.velocity * 2 * DT
        if stopped_s is not None and step.at_rest:
            break
    # The first late tick after the ramp's end is the last.
    assert time_s - stopped_s < step._stack._brake.duration_s + 2 * DT


class Stick(InputSource):
    def __init__(self, script):
        self.script, self.ticks = script, 0

    def latest(self, now_s):
        self.ticks += 1
        return Input(np.array([float(self.script(self.ticks))])), 0.0


def give_up(loop):
    raise AssertionError("the loop goes on")


def loop_of(arm, scripted, script, observers=()):
    clock = SimulatedClock()
    simulated = KinematicArm(arm, arm.home, clock.now_s)
    simulated.connect()
    controller = scripted(np.full((1, 7), 0.3))
    step = Step(arm, controller, SafetyConfig(), dt_s=DT)
    parts = SimpleNamespace(records=[], arm=simulated, clock=clock, controller=controller, step=step)
    parts.loop = ControlLoop(
        step, simulated, Stick(script), clock, [parts.records.append, *(f(parts) for f in observers)]
    )
    return parts


def calling(tick, call):
    def made(parts):
        return lambda record: call(parts.loop) if len(parts.records) == tick else None

    return made


def test_a_step_that_stalls_past_the_last_command_sends_no_old_one(arm, scripted):
    parts = loop_of(arm, scripted, lambda tick: tick > 5, [calling(2, lambda loop: loop.enable())])

    def stall(context):
        if 0.495 < parts.clock.now_s() < 0.505:
            parts.clock.wait_until(parts.clock.now_s() + 0.1)
        return np.full(7, 0.3)

    parts.controller.answer = stall
    parts.loop.run(ticks=100)
    late = [record for record in parts.records if record.time_s > 0.505]
    assert any(record.command.velocity.any() for record in parts.records)
    assert not any(record.command.velocity.any() for record in late)
    assert "late" in late[0].command.stop.reason


def test_a_loop_that_ends_cannot_be_enabled_again(arm, scripted):
    # The stick goes neutral for one tick after the loop was told to finish, and is pushed again.
    parts = loop_of(
        arm,
        scripted,
        lambda tick: 5 < tick < 41 or tick > 42,
        [calling(2, lambda loop: loop.enable()), calling(40, lambda loop: (loop.finish(), loop.enable()))],
    )
    parts.loop._observers += (calling(120, give_up)(parts),)
    parts.loop.run(ticks=300)
    assert len(parts.records) < 60


def test_a_stop_wins_over_an_enable_of_the_same_tick(arm, scripted):
    parts = loop_of(
        arm,
        scripted,
        lambda tick: 5 < tick < 40 or tick > 45,
        [
            calling(2, lambda loop: loop.enable()),
            calling(41, lambda loop: (loop.stop("Stop."), loop.enable())),
        ],
    )
    parts.loop.run(ticks=80)
    assert not any(record.command.velocity.any() for record in parts.records[60:])


def test_an_arm_that_several_links_are_wedged_with_can_be_backed_out(arm, scripted, oracle):
    # At home hand, wrist and forearm are all inside this ball, and want out in different directions.
    rng = np.random.default_rng(4)
    np.linalg.qr(rng.normal(size=(3, 3)))
    centre = arm.chain.forward(arm.home).position + rng.normal(size=3) * 0.03
    measure = oracle(arm, (Sphere("ball", centre, rng.uniform(0.03, 0.1)),))
    depth = measure.clearance(arm.home)
    assert depth < -0.05
    controller = scripted(np.zeros((1, 7)))
    step = Step(arm, controller, SafetyConfig(obstacles=measure.obstacles), dt_s=DT)
    stepped(step, NEUTRAL, 0.0, arm.home, now_s())
    assert step.enable() is None
    # The way in which what is too near gets further away fastest, all of it at once.
    q, nudge = arm.home, 1e-6 * np.eye(7)
    near = measure.distances(q) < 0.02
    slopes = ((measure.distances(q + nudge) - measure.distances(q - nudge)) / 2e-6)[:, near].T
    slopes = slopes[np.abs(slopes).max(axis=1) > 1e-6]
    most = np.hstack([-slopes, np.ones((len(slopes), 1))])
    out = linprog([0.0] * 7 + [-1.0], most, np.zeros(len(slopes)), bounds=[(-1, 1)] * 7 + [(None, None)])
    controller.matrix = out.x[None, :7]
    for _ in range(200):
        q = q + stepped(step, PUSH, 0.0, q, now_s()).command.velocity * DT
        assert measure.clearance(q) >= depth - 1e-8
    assert measure.clearance(q) > depth + 0.01


@pytest.mark.parametrize("sequence", [math.nan, math.inf, "7", None, 8.0])
def test_a_number_that_is_none_is_stale(sequence):
    port = InputPort(1, SimulatedClock())
    nonce = port.issue_nonce()
    assert port.offer(PUSH, nonce, 1)
    assert not port.offer(PUSH, nonce, sequence)
    assert not port.offer(PUSH, [nonce], 2)
    assert not port.offer(PUSH, nonce, 0)
    assert port.offer(PUSH, nonce, 2)


@pytest.mark.parametrize(
    "limits",
    [
        {"workspace": (np.zeros(3), np.ones(3))},
        {"obstacles": None},
        {"obstacles": Sphere("ball", np.ones(3), 0.1)},
        {"obstacles": ("table",)},
        {"obstacles": (SimpleNamespace(name="ball", centre=np.ones(3), radius=0.1),)},
        {"obstacles": (Sphere("ball", [[1], [1, 2]], 0.1),)},
        {"joint_speed": 10**400},
    ],
    ids=lambda limits: f"{next(iter(limits))} {type(next(iter(limits.values()))).__name__}",
)
def test_what_is_no_limit_is_refused_and_never_left_out(limits):
    with pytest.raises(UserError):
        SafetyConfig(**limits)


def test_corners_that_are_ragged_are_refused():
    with pytest.raises(UserError, match="lower"):
        Workspace([[1], [1, 2]], np.ones(3))


@pytest.mark.parametrize("period", [None, "0.01", True])
def test_a_period_that_is_no_number_is_refused(arm, period):
    with pytest.raises(UserError, match="period"):
        Bounds(SafetyConfig(), arm, period)
