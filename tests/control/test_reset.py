"""A step that is reset behaves as a new one, whatever happened before."""

from dataclasses import replace

import numpy as np
import pytest

from latentarm.assistance.boltzmann import BoltzmannBelief
from latentarm.control.step import Step
from latentarm.core.types import Goal, GripperReading, Input, Reading
from latentarm.robots.gripper import Gripper
from latentarm.safety.config import SafetyConfig
from latentarm.safety.yielding import YIELDING

DT = 0.01
HAND = Gripper(("left", "right"), 0.08, 0.1, 70.0)
NEUTRAL, PUSH = Input(np.zeros(1)), Input(np.ones(1))


class Driven:
    """A step and an arm that does as it is told, but for joints that end at a wall."""

    def __init__(self, robot, scripted):
        self.robot = replace(robot, gripper=HAND)
        goals = tuple(
            Goal(str(shift), robot.home + shift, robot.chain.forward(robot.home + shift))
            for shift in (0.5, -0.5)
        )
        belief = BoltzmannBelief([goal.configuration for goal in goals], period_s=DT)
        controller = scripted(np.full((1, 7), 0.3), modes=("one", "two"))
        self.step = Step(self.robot, controller, SafetyConfig(), goals=goals, belief=belief, dt_s=DT)
        self.begin(robot.home)

    def begin(self, q):
        self.q = q
        self.wall = np.full(7, np.inf)
        self.step.reset(q)

    def tick(self, number, given=PUSH, q=None, hand=0.05):
        time_s = DT * number
        noise = np.random.default_rng(number).normal(scale=1e-5, size=7)
        measured = np.minimum(self.q, self.wall) + noise if q is None else q
        reading = Reading(measured, np.zeros(7), time_s, number % 200, GripperReading(hand, hand < 0.05))
        record = self.step(given, 0.0, reading, time_s)
        self.q = self.q + DT * record.command.velocity
        return record


def drives(driven):
    driven.tick(0, NEUTRAL)
    driven.step.enable()
    for number in range(1, 60):
        driven.tick(number)


def holds_the_switch(driven):
    driven.tick(0, Input(np.zeros(1), switch_mode=True))


def closes_the_gripper(driven):
    driven.tick(0, NEUTRAL)
    driven.step.enable()
    driven.tick(1, Input(np.zeros(1), gripper="close"), hand=0.02)


def holds_the_opening_button(driven):
    for number in range(60):
        driven.tick(number, Input(np.zeros(1), opens=True))


def jumps(driven):
    driven.tick(198, NEUTRAL)
    driven.tick(199, NEUTRAL, driven.q + 1.0)


def presses(driven):
    """Into a wall, and draws back from it."""
    drives(driven)
    driven.wall = driven.q.copy()
    assert any(YIELDING in driven.tick(number).command.limited_by for number in range(60, 140))


def loses_time(driven):
    drives(driven)
    driven.tick(90)


@pytest.mark.parametrize("opening", [1, 110])
@pytest.mark.parametrize(
    "before",
    [drives, holds_the_switch, closes_the_gripper, holds_the_opening_button, jumps, presses, loses_time],
)
def test_nothing_of_before_counts(arm, scripted, before, opening):
    """A new drive elsewhere: the opening button is held for some ticks, then the arm goes into a wall."""
    used, new = Driven(arm, scripted), Driven(arm, scripted)
    before(used)
    for driven in (used, new):
        driven.begin(arm.home + 0.1)
    np.testing.assert_array_equal(used.step.belief, new.step.belief)
    opens = [Input(np.zeros(1), switch_mode=True, opens=True)] * opening
    yielded = opened = False
    for number, given in enumerate([*opens, NEUTRAL, *[PUSH] * 160], 200):
        first, second = (driven.tick(number, given) for driven in (used, new))
        assert first.command.velocity.tobytes() == second.command.velocity.tobytes()
        assert (first.command.stop, first.command.limited_by) == (
            second.command.stop,
            second.command.limited_by,
        )
        assert (first.command.gripper, first.mode) == (second.command.gripper, second.mode)
        np.testing.assert_array_equal(first.belief, second.belief)
        yielded |= YIELDING in first.command.limited_by
        opened |= first.command.gripper is not None and first.command.gripper.speed_m_s > 0.0
        if number == 200 + opening:
            assert used.step.enable() is new.step.enable() is None
        if number == 240 + opening:
            for driven in (used, new):
                driven.wall = driven.q.copy()
    assert yielded
    assert opened == (opening > 100)
