"""What a person asks of the gripper, and what leaves the loop for it."""

import itertools
import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.control.export import demonstrations_of
from latentarm.control.journal import JournalEpisode
from latentarm.control.recorder import EpisodeHeader
from latentarm.control.safety.config import SafetyConfig
from latentarm.control.safety.gripper import GripperFilter
from latentarm.control.step import Step
from latentarm.controllers.end_effector import EndEffectorController
from latentarm.robots.catalogue import load_robot
from latentarm.robots.gripper import Gripper
from latentarm.types import (
    GripperAsk,
    GripperCommand,
    GripperReading,
    Input,
    Reading,
    StepRecord,
)

WIDE: Final = 0.08
HAND: Final = Gripper(("left", "right"), WIDE, 0.1, 70.0)
OPEN: Final = GripperReading(WIDE)


def made(engaged_reading: GripperReading = OPEN) -> GripperFilter:
    gripper = GripperFilter(HAND, SafetyConfig())
    gripper.tick()
    assert gripper.saw(engaged_reading) is None
    return gripper


class Driven:
    """A `Step` of an arm with a hand, called every 10 ms with what a test gives."""

    def __init__(self) -> None:
        robot = replace(load_robot("panda"), gripper=HAND)
        self.q = robot.home
        self.step = Step(robot, EndEffectorController(robot), SafetyConfig())
        self.step.reset(self.q)
        self._tick = itertools.count()
        self.tick()
        self.step.enable()

    def tick(
        self,
        asked: GripperAsk | None = None,
        hand: GripperReading | None = OPEN,
        age_s: float = 0.0,
        u: float = 0.0,
    ) -> StepRecord:
        number = next(self._tick)
        reading = Reading(self.q, np.zeros(7), 0.01 * number, number, hand)
        return self.step(Input(np.array([u, 0.0]), gripper=asked), age_s, reading, 0.01 * number)


def test_close_sends_width_speed_and_force_within_the_limits_until_it_is_asked_again() -> None:
    driven = Driven()
    assert driven.tick().command.gripper is None
    closing = driven.tick("close").command.gripper
    assert closing == GripperCommand(0.0, 0.05, 20.0)
    assert driven.tick().command.gripper == closing
    opening = driven.tick("open").command.gripper
    assert opening is not None
    assert opening.width_m == WIDE


@given(
    ticks=st.lists(
        st.tuples(
            st.sampled_from((None, "open", "close", "toggle")),
            st.floats(0, WIDE),
            st.booleans(),
            st.booleans(),
        ),
        min_size=2,
        max_size=12,
    )
)
def test_controllers_see_what_a_dataset_of_the_drive_says_the_gripper_was_told(
    ticks: list[tuple[GripperAsk | None, float, bool, bool]],
) -> None:
    driven = Driven()
    records: list[StepRecord] = []
    seen: list[float] = []
    for asked, width_m, holding, stops in ticks:
        if stops:
            driven.step.stop("The person stops it.")
        records.append(driven.tick(asked, GripperReading(width_m, holding)))
        seen += driven.step.context(driven.q).gripper_target.tolist()
    header = EpisodeHeader("panda", tuple(f"joint{joint}" for joint in range(1, 8)), 100.0)
    found = demonstrations_of([JournalEpisode(header, tuple(records), True)], source="here").episodes[0]
    np.testing.assert_allclose(found.extras["action.gripper"].ravel(), seen, atol=1e-12)


def test_a_held_button_toggles_once() -> None:
    driven = Driven()
    widths = [driven.tick(asked).command.gripper for asked in ("toggle", "toggle", None, "toggle")]
    assert [one.width_m for one in widths if one is not None] == [0.0, 0.0, 0.0, WIDE]


@pytest.mark.parametrize("asked", ["open", "close", "toggle"])
def test_a_stale_input_or_a_stopped_arm_never_moves_the_gripper(asked: GripperAsk) -> None:
    driven = Driven()
    assert driven.tick(asked, age_s=1.0).command.gripper is None
    assert driven.tick(asked).command.gripper is None  # the arm has to be enabled first
    driven.tick()
    driven.step.enable()
    assert driven.tick(asked).command.gripper is not None


def test_a_button_that_was_held_when_the_arm_is_enabled_does_not_count() -> None:
    driven = Driven()
    driven.step.stop("Stop.")
    driven.tick("close")
    driven.step.enable()
    assert driven.tick("close").command.gripper is None


def test_a_stop_freezes_fingers_in_motion_where_they_are() -> None:
    driven = Driven()
    driven.tick("close")
    driven.step.stop("Stop.")
    halfway = driven.tick(hand=GripperReading(0.051)).command.gripper
    assert halfway is not None
    assert halfway.width_m == 0.051
    later = driven.tick(hand=GripperReading(0.049)).command.gripper
    assert later == halfway
    driven.step.enable()
    assert driven.tick(hand=GripperReading(0.05)).command.gripper == halfway


def test_a_stop_drops_nothing() -> None:
    driven = Driven()
    driven.tick("close")
    held = driven.tick(hand=GripperReading(0.06, holding=True)).command.gripper
    driven.step.stop("Stop.")
    assert driven.tick(hand=GripperReading(0.06, holding=True)).command.gripper == held


def test_what_was_held_before_the_first_ask_is_opened_by_a_toggle() -> None:
    driven = Driven()
    opened = driven.tick("toggle", hand=GripperReading(0.06, holding=True)).command.gripper
    assert opened is not None
    assert opened.width_m == WIDE


@pytest.mark.parametrize("hand", [None, GripperReading(math.nan), GripperReading(0.2), GripperReading(-1.0)])
def test_an_arm_whose_gripper_cannot_be_read_stops(hand: GripperReading | None) -> None:
    driven = Driven()
    record = driven.tick(hand=hand)
    assert record.command.stop is not None
    assert "gripper" in record.command.stop.reason
    assert record.gripper is None


def test_an_ask_that_does_not_exist_stops_the_arm() -> None:
    driven = Driven()
    record = driven.tick("squeeze")  # pyright: ignore[reportArgumentType]
    assert record.command.stop is not None
    assert "gripper" in record.command.stop.reason


def test_without_a_gripper_nothing_is_asked_of_it() -> None:
    gripper = GripperFilter(None, SafetyConfig())
    assert gripper.saw(None) is None
    gripper.ask("close", engaged=True)
    assert gripper.command(engaged=True, falters=False) is None


def test_fingers_wait_while_inputs_falter_and_then_go_on() -> None:
    gripper = made()
    gripper.ask("close", engaged=True)
    gripper.saw(GripperReading(0.05))
    waiting = gripper.command(engaged=True, falters=True)
    assert waiting is not None
    assert waiting.width_m == 0.05
    going = gripper.command(engaged=True, falters=False)
    assert going is not None
    assert going.width_m == 0.0


@given(
    ticks=st.lists(
        st.tuples(
            st.sampled_from(["open", "close", "toggle", None]),
            st.floats(allow_nan=True, allow_infinity=True),
            st.booleans(),
            st.booleans(),
            st.booleans(),
        ),
        max_size=30,
    ),
    speed=st.floats(0.001, 1.0),
    force=st.floats(0.1, 500.0),
)
def test_every_command_is_finite_and_within_the_limits(
    ticks: list[tuple[GripperAsk | None, float, bool, bool, bool]], speed: float, force: float
) -> None:
    gripper = GripperFilter(HAND, SafetyConfig(gripper_speed=speed, gripper_force=force))
    for asked, width, holding, engaged, falters in ticks:
        gripper.tick()
        gripper.saw(GripperReading(width, holding))
        gripper.ask(asked, engaged=engaged)
        command = gripper.command(engaged=engaged, falters=falters)
        if command is not None:
            assert 0.0 <= command.width_m <= WIDE
            assert 0.0 < command.speed_m_s <= min(speed, HAND.speed_m_s)
            assert 0.0 < command.force_n <= min(force, HAND.force_n)
