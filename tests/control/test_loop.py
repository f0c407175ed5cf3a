import math
import sys
import threading
import time

import numpy as np
import pytest

from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import Clock, MonotonicClock, SimulatedClock
from latentarm.control.input_port import InputSource
from latentarm.control.loop import ControlLoop
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import Input
from latentarm.safety.config import SafetyConfig

MATRIX = np.full((1, 7), 0.2)


class Stick(InputSource):
    """Neutral for some ticks, then pushed."""

    def __init__(self, neutral=3, age=lambda tick: 0.0):
        self.tick = 0
        self.neutral = neutral
        self.age = age

    def latest(self, now_s):
        self.tick += 1
        return Input(np.full(1, 0.0 if self.tick <= self.neutral else 1.0)), self.age(self.tick)


class Stuttering(Clock):
    """A simulated clock that wakes up late now and then."""

    def __init__(self, inner, late):
        self.inner = inner
        self.late = late
        self.waits = 0

    def now_s(self):
        return self.inner.now_s()

    def wait_until(self, time_s):
        self.waits += 1
        self.inner.wait_until(time_s + self.late.get(self.waits, 0.0))


def connected(robot, clock):
    arm = KinematicArm(robot, robot.home, clock.now_s)
    arm.connect()
    return arm


@pytest.fixture
def setup(arm, scripted):
    def make(late=None, observers=(), source=None):
        clock = SimulatedClock()
        simulated = connected(arm, clock)
        step = Step(arm, scripted(MATRIX), SafetyConfig())
        records = []
        loop = ControlLoop(
            step,
            simulated,
            source or Stick(),
            Stuttering(clock, late) if late else clock,
            [records.append, *observers],
        )
        loop.enable_at = None
        return loop, simulated, records, step

    return make


def enabling(loop, tick):
    """An observer that presses Enable at a tick."""
    seen = []

    def observe(record):
        seen.append(record)
        if len(seen) == tick:
            loop.enable()

    return observe


def test_drives_and_comes_to_rest(setup, arm):
    loop, simulated, records, step = setup()
    loop._observers += (enabling(loop, 2),)
    loop.run(ticks=100)
    assert np.abs(simulated.read().q - arm.home).max() > 0.05
    assert not records[-1].command.velocity.any()
    assert step.at_rest
    assert loop.ticks >= 100
    assert loop.met_share == 1.0
    # The arm moved by exactly what was commanded, so it never ran on by itself.
    moved = sum(record.command.velocity for record in records) * 0.01
    np.testing.assert_allclose(simulated.read().q - arm.home, moved, atol=1e-12)


def test_never_enabled_never_moves(setup, arm):
    loop, simulated, _, _ = setup()
    loop.run(ticks=50)
    np.testing.assert_array_equal(simulated.read().q, arm.home)


def test_enable_with_the_stick_pushed_is_refused(setup, arm):
    loop, simulated, _, _ = setup(source=Stick(neutral=0))
    loop.enable()
    loop.run(ticks=20)
    np.testing.assert_array_equal(simulated.read().q, arm.home)


def test_a_stop_wins_over_an_enable(setup, arm):
    loop, simulated, _, _ = setup(source=Stick(neutral=5))
    loop.enable()
    loop.stop("Stop was pressed.")
    loop.run(ticks=30)
    np.testing.assert_array_equal(simulated.read().q, arm.home)


def test_ticks_keep_to_the_grid_after_a_late_one(setup):
    loop, _, records, _ = setup(late={10: 0.0137, 20: 0.004})
    loop.run(ticks=40)
    times = np.array([record.time_s for record in records])
    on_grid = np.abs(times / 0.01 - np.round(times / 0.01)) < 1e-6
    assert (~on_grid).sum() == 2
    assert len(set(np.round(times / 0.01).astype(int))) == len(times)


def test_small_delays_do_not_stop_the_arm(setup):
    loop, _, records, _ = setup(late={20: 0.008})
    loop._observers += (enabling(loop, 2),)
    loop.run(ticks=60)
    assert records[55].command.stop is None


def test_a_tick_after_the_command_ran_out_stops_for_good(setup):
    loop, _simulated, records, _ = setup(late={30: 0.05})
    loop._observers += (enabling(loop, 2),)
    loop.run(ticks=80)
    assert loop.met_share == pytest.approx(1 - 1 / loop.ticks)
    assert records[28].command.velocity.any()
    for record in records[29:]:
        assert "late" in record.command.stop.reason
        # The arm had stopped by itself: it must not be told to go on, not even ramping down.
        assert not record.command.velocity.any()


def test_a_stale_source_stops_the_arm(setup):
    loop, _, records, _ = setup(source=Stick(age=lambda tick: math.inf if tick > 50 else 0.0))
    loop._observers += (enabling(loop, 2),)
    loop.run(ticks=100)
    assert records[48].command.velocity.any()
    assert records[60].command.stop is not None
    assert not records[70].command.velocity.any()


def test_an_observer_that_fails_leaves_the_arm_ramped_to_rest(setup):
    def fail(record):
        if record.command.velocity.any() and record.time_s > 0.5:
            raise UserError("The disk is full.")

    loop, simulated, _records, step = setup()
    loop._observers = (*loop._observers, enabling(loop, 2), fail)
    sent = []
    send = simulated.send
    simulated.send = lambda command: (sent.append(command.velocity), send(command))
    with pytest.raises(UserError, match="disk"):
        loop.run(ticks=100)
    assert step.at_rest
    assert not simulated.read().dq.any()
    sent = np.array(sent)
    assert not sent[-1].any()
    assert (np.abs(np.diff(sent, axis=0)) <= step._stack.bounds.stop_acceleration * 0.01 + 1e-9).all()


def test_finish_from_another_thread_ends_a_real_loop(arm, scripted):
    clock = MonotonicClock()
    step, records = Step(arm, scripted(MATRIX), SafetyConfig()), []
    loop = ControlLoop(step, connected(arm, clock), Stick(), clock, [records.append])
    thread = threading.Thread(target=loop.run)
    thread.start()
    time.sleep(0.15)
    loop.finish()
    thread.join(timeout=5.0)
    assert not thread.is_alive()
    assert loop.ticks >= 3
    # The arm goes on measuring while a tick is under way: such readings are as good as any.
    assert np.isfinite([record.state for record in records]).all()


@pytest.mark.parametrize("leap_s", [-3600.0, -0.2, 0.2, 3600.0])
@pytest.mark.parametrize("when", ["waiting", "working"])
def test_a_clock_that_leaps_stops_the_arm_and_the_loop_goes_on(setup, leap_s, when):
    class Leaping(Clock):
        def __init__(self, inner):
            self.inner, self.leap_s, self.longest_s = inner, 0.0, 0.0

        def now_s(self):
            return self.inner.now_s() + self.leap_s

        def wait_until(self, time_s):
            self.longest_s = max(self.longest_s, time_s - self.now_s())
            self.inner.wait_until(time_s - self.leap_s)
            if when == "waiting" and abs(self.inner.now_s() - 0.6) < 1e-6:
                self.leap_s = leap_s

    loop, simulated, records, _ = setup()
    clock = loop._clock = Leaping(loop._clock)
    simulated._now_s = clock.now_s

    def leap(record):
        if when == "working" and len(records) == 60:
            clock.leap_s = leap_s

    loop._observers += (enabling(loop, 2), leap)
    loop.run(ticks=120)
    assert records[58].command.velocity.any()
    for record in records[62:]:
        assert not record.command.velocity.any()
        assert record.command.stop is not None
    # Nobody waits for the old time to come round again.
    assert clock.longest_s < 0.02
    assert len(records) >= 120


def test_a_clock_that_stands_still_stops_the_arm(setup):
    class Stopped(Clock):
        def __init__(self, inner):
            self.inner, self.waits = inner, 0

        def now_s(self):
            return min(self.inner.now_s(), 0.6)

        def wait_until(self, time_s):
            self.waits += 1
            self.inner.wait_until(self.inner.now_s() + time_s - self.now_s())

    loop, simulated, records, _ = setup()
    clock = loop._clock = Stopped(loop._clock)
    simulated._now_s = clock.now_s
    loop._observers += (enabling(loop, 2),)
    loop.run(ticks=120)
    assert records[58].command.velocity.any()
    assert not any(record.command.velocity.any() for record in records[62:])
    assert "clock" in records[-1].command.stop.reason
    assert not simulated.read().dq.any()
    # A tick a period goes on, so that Stop, Enable and the end of the loop are still heard.
    assert clock.inner.now_s() < 1.3


def test_the_machine_s_clock_counts_sleep_where_it_can():
    clock = MonotonicClock()
    before_s = time.clock_gettime(time.CLOCK_BOOTTIME) if sys.platform == "linux" else time.monotonic()
    now_s = clock.now_s()
    assert 0.0 <= now_s - before_s < 1.0
    clock.wait_until(now_s + 0.002)
    assert clock.now_s() >= now_s + 0.002
