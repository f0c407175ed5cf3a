"""The loop heeds what the arm says of itself: it enables it, and stops when it takes no commands."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.arms.contract import ArmStatus
from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import SimulatedClock
from latentarm.control.input_port import InputSource
from latentarm.control.loop import ENABLING_S, ControlLoop
from latentarm.control.step import Step
from latentarm.core.errors import UserError
from latentarm.core.types import GripperCommand, Input
from latentarm.safety.config import SafetyConfig
from latentarm.testing.faults import FaultyArm


class Stick(InputSource):
    pushed = False

    def latest(self, now_s):
        return Input(np.full(1, float(self.pushed))), 0.0


class Rig:
    """A loop over an arm with faults; ``at[tick]`` is called after that tick."""

    def __init__(self, robot, scripted):
        self.clock = SimulatedClock()
        self.plant = KinematicArm(robot, robot.home, self.clock.now_s)
        self.arm = FaultyArm(self.plant, self.clock.now_s)
        self.stick, self.at, self.records = Stick(), {}, []
        self.step = Step(robot, scripted(np.full((1, 7), 0.2)), SafetyConfig())
        self.arm.connect()
        self.loop = ControlLoop(self.step, self.arm, self.stick, self.clock, [self._observe])

    def _observe(self, record):
        self.records.append(record)
        if (then := self.at.get(len(self.records))) is not None:
            then()

    def push(self):
        self.stick.pushed = True

    def let_go_and_enable(self):
        self.stick.pushed = False
        self.loop.enable()


@pytest.fixture
def rig(arm, scripted):
    return Rig(arm, scripted)


def said(record):
    return None if record.command.stop is None else record.command.stop.reason


def test_enabling_enables_the_arm_and_the_end_disables_it(rig):
    rig.at = {2: rig.loop.enable, 5: rig.push}
    assert rig.arm.status().phase == "disabled"
    rig.loop.run(40)
    assert max(np.abs(record.command.velocity).max() for record in rig.records) > 0.1
    assert rig.arm.status().phase == "disabled"


def test_an_arm_that_breaks_down_says_why_and_goes_on_when_it_is_enabled_again(rig):
    rig.at = {
        2: rig.loop.enable,
        5: rig.push,
        60: lambda: rig.arm.break_down("The arm has hit something.", recoverable=True),
        80: rig.let_go_and_enable,
        85: rig.push,
    }
    rig.loop.run(120)
    stopped = rig.records[60]
    assert said(stopped) == "The arm has hit something."
    # The arm has stopped by itself: to go on ramping down would be a command that it does not follow.
    assert not stopped.command.velocity.any()
    assert not any(record.command.velocity.any() for record in rig.records[60:84])
    assert rig.records[110].command.velocity.any()


def test_a_fault_that_needs_the_maker_is_not_recovered_from(rig):
    rig.at = {
        2: rig.loop.enable,
        20: lambda: rig.arm.break_down("A brake does not open.", recoverable=False),
        30: rig.loop.enable,
        40: rig.push,
    }
    rig.loop.run(80)
    assert said(rig.records[79]) == "A brake does not open."
    assert not any(record.command.velocity.any() for record in rig.records)


def test_who_enables_an_arm_with_the_button_pressed_reads_why_it_stays(rig):
    rig.at = {1: rig.arm.press_emergency_stop, 3: rig.loop.enable}
    rig.loop.run(20)
    assert said(rig.records[1]) == "The arm is not enabled yet."
    assert said(rig.records[19]) == "The emergency stop on the arm is pressed."


@pytest.mark.parametrize(("takes_s", "ready"), [(1.0, True), (2.0 * ENABLING_S, False)])
def test_an_arm_may_take_its_time_to_become_ready(rig, monkeypatch, takes_s, ready):
    asked_s = []

    def enable():
        asked_s.append(rig.clock.now_s())
        if rig.clock.now_s() - asked_s[0] >= takes_s:
            rig.plant.enable()

    monkeypatch.setattr(rig.arm, "enable", enable)
    rig.at = {2: rig.loop.enable}
    rig.loop.run(round((takes_s + 0.2) * 100))
    assert rig.arm.read().time_s > takes_s
    assert (said(rig.records[-2]) is None) == ready
    if not ready:
        assert asked_s[-1] - asked_s[0] <= ENABLING_S + 0.01


def test_each_time_the_arm_has_as_long_to_become_ready(rig, monkeypatch):
    asked_s = []

    def enable():
        asked_s.append(rig.clock.now_s())
        if asked_s[-1] > ENABLING_S + 1.5:
            rig.plant.enable()

    monkeypatch.setattr(rig.arm, "enable", enable)
    rig.at = {2: rig.loop.enable, round(100 * ENABLING_S) + 50: rig.loop.enable}
    rig.loop.run(round(100 * (ENABLING_S + 2.0)))
    assert np.diff(asked_s).max() > 0.3, "the first wait has ended"
    assert said(rig.records[-2]) is None


class OpeningButton(InputSource):
    def latest(self, now_s):
        return Input(np.zeros(1), opens=True), 0.0


def test_the_fingers_of_an_arm_that_is_not_enabled_are_opened(rig):
    rig.plant.move_gripper(GripperCommand(0.0, 0.1, 20.0))
    rig.clock.wait_until(1.0)
    assert rig.plant.read().gripper.width_m == 0.0
    ControlLoop(rig.step, rig.arm, OpeningButton(), rig.clock).run(300)
    assert rig.plant.read().gripper.width_m == rig.step.robot.gripper.width_m
    assert rig.step.stopped is not None


def test_a_stop_ends_the_wait_for_the_arm(rig, monkeypatch):
    monkeypatch.setattr(rig.arm, "enable", lambda: None)
    rig.at = {
        2: rig.loop.enable,
        10: lambda: rig.loop.stop("Stop was pressed."),
        20: monkeypatch.undo,
    }
    rig.loop.run(60)
    assert rig.plant.status().phase == "disabled"
    assert all(said(record) is not None for record in rig.records)


def test_an_arm_that_takes_fewer_commands_is_refused(rig):
    rig.plant._spec = replace(rig.plant.spec, rate_hz=50.0)
    with pytest.raises(UserError, match="runs at 100 Hz, but the arm takes 50 commands per second"):
        ControlLoop(rig.step, rig.arm, rig.stick, rig.clock)


def test_an_arm_that_drops_out_by_itself_is_noticed(rig):
    rig.at = {2: rig.loop.enable, 5: rig.push, 30: rig.plant.disable}
    rig.loop.run(50)
    assert said(rig.records[30]) == ArmStatus("disabled", "The arm is not enabled yet.").reason
    assert not rig.records[31].command.velocity.any()


def test_an_arm_that_takes_no_commands_any_more_does_not_go_on_drawing_back(rig):
    """A collision that the arm itself notices while it yields: what follows is up to the person."""
    still = rig.step.robot.home.copy()
    noise = np.random.default_rng(0)
    read = rig.arm.read

    def held():
        reading = read()
        q = np.where(np.arange(7) == 1, still, reading.q) + noise.normal(scale=1e-5, size=7)
        return replace(reading, q=q)

    rig.arm.read = held
    rig.at[3] = rig.let_go_and_enable
    rig.at[10] = rig.push
    drawing = []

    def watch(record):
        if "yielding" in record.command.limited_by:
            drawing.append(len(rig.records))
            if len(drawing) == 5:
                rig.arm.press_emergency_stop()

    rig.loop = ControlLoop(rig.step, rig.arm, rig.stick, rig.clock, [rig._observe, watch])
    rig.loop.run(ticks=250)
    assert len(drawing) == 5
    assert not any(one.command.velocity.any() for one in rig.records[drawing[-1] :])
