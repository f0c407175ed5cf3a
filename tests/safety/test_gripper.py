"""What a person asks of the gripper, and what leaves the loop for it."""

import itertools
import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.controllers.end_effector import EndEffectorController
from latentarm.control.step import Step
from latentarm.core.types import (
    GripperAsk,
    GripperCommand,
    GripperReading,
    Input,
    Reading,
    StepRecord,
)
from latentarm.recordings.dataset_export import demonstrations_of
from latentarm.recordings.journal_reader import JournalEpisode
from latentarm.recordings.journal_writer import EpisodeHeader
from latentarm.robots.catalogue import load_robot
from latentarm.robots.gripper import Gripper
from latentarm.safety.config import SafetyConfig
from latentarm.safety.gripper import GripperFilter

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
        self.step = Step(robot, EndEffectorController(robot), SafetyConfig(input_grace_s=0.05))
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
        pace: float = 1.0,
        opens: bool = False,
    ) -> StepRecord:
        number = next(self._tick)
        reading = Reading(self.q, np.zeros(7), 0.01 * number, number, hand)
        given = Input(np.array([u, 0.0]), gripper=asked, pace=pace, opens=opens)
        return self.step(given, age_s, reading, 0.01 * number)

    def hold(self, seconds: float, hand: GripperReading | None = OPEN) -> list[GripperCommand | None]:
        """Hold down what opens the gripper."""
        return [self.tick(hand=hand, opens=True).command.gripper for _ in range(round(100 * seconds))]


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
    assert (halfway.width_m, halfway.speed_m_s) == (0.051, 0.0)
    later = driven.tick(hand=GripperReading(0.049)).command.gripper
    assert later == halfway
    driven.step.enable()
    assert driven.tick(hand=GripperReading(0.05)).command.gripper == halfway


def test_a_stop_drops_nothing() -> None:
    driven = Driven()
    driven.tick("close")
    held = driven.tick(hand=GripperReading(0.06, holding=True)).command.gripper
    assert held is not None
    driven.step.stop("Stop.")
    stopped = driven.tick(hand=GripperReading(0.06, holding=True)).command.gripper
    assert stopped == replace(held, speed_m_s=0.0)
    driven.step.enable()
    assert driven.tick(hand=GripperReading(0.06, holding=True)).command.gripper == stopped
    assert driven.tick("close", hand=GripperReading(0.06, holding=True)).command.gripper == held


def test_what_was_held_before_the_first_ask_is_opened_by_a_toggle() -> None:
    driven = Driven()
    opened = driven.tick("toggle", hand=GripperReading(0.06, holding=True)).command.gripper
    assert opened is not None
    assert opened.width_m == WIDE


def test_a_toggle_closes_fingers_that_were_spread_by_hand_since_they_held_something() -> None:
    driven = Driven()
    driven.tick("close")
    driven.tick(hand=GripperReading(0.06, holding=True))
    driven.step.stop("Stop.")
    driven.tick(hand=GripperReading(0.06, holding=True))
    driven.step.enable()
    driven.tick()
    closing = driven.tick("toggle").command.gripper
    assert closing is not None
    assert closing.width_m == 0.0


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
    gripper.guided("close")
    assert gripper.command(0.0, 1.0, engaged=True) is None
    gripper.guided("close")
    assert gripper.command(0.01, 1.0, engaged=False, opens=True) is None
    assert gripper.command(1.01, 1.0, engaged=False, opens=True) is None


def test_fingers_wait_while_inputs_falter_and_then_go_on() -> None:
    gripper = made()
    gripper.ask("close", engaged=True)
    gripper.saw(GripperReading(0.05))
    waiting = gripper.command(0.0, 0.0, engaged=True)
    assert waiting is not None
    assert waiting.speed_m_s == 0.0
    going = gripper.command(0.01, 1.0, engaged=True)
    assert going is not None
    assert (going.width_m, going.speed_m_s) == (0.0, 0.05)


def test_inputs_that_falter_let_fingers_wait() -> None:
    driven = Driven()
    driven.tick("close")
    waiting = driven.tick(age_s=0.08).command.gripper
    assert waiting is not None
    assert waiting.speed_m_s == 0.0
    assert driven.step.stopped is None
    going = driven.tick().command.gripper
    assert going is not None
    assert going.speed_m_s == 0.05


@pytest.mark.parametrize("pace", [0.0, 0.3])
def test_pace_slows_the_gripper(pace: float) -> None:
    driven = Driven()
    closing = driven.tick("close", pace=pace).command.gripper
    assert closing is not None
    assert closing.speed_m_s == pytest.approx(0.05 * pace)


@pytest.mark.parametrize(("before", "by_hand"), [("open", "close"), ("close", "open")])
def test_what_guiding_did_with_the_gripper_stands_when_the_arm_is_enabled(
    before: GripperAsk, by_hand: GripperAsk
) -> None:
    driven = Driven()
    driven.tick(before)
    driven.step.stop("Stop.")
    driven.tick()
    driven.step.guided(by_hand)
    moved = driven.tick().command.gripper
    assert moved is not None
    assert (moved.width_m, moved.speed_m_s) == (WIDE if by_hand == "open" else 0.0, 0.05)
    held = GripperReading(0.06, holding=True) if by_hand == "close" else OPEN
    driven.step.guided(None)
    assert driven.tick(hand=held).command.gripper == moved
    driven.step.enable()
    for _ in range(20):
        after = driven.tick(hand=held).command.gripper
        assert after == replace(moved, speed_m_s=0.0)
    assert driven.step.context(driven.q).gripper_target[0] == moved.width_m


def test_fingers_stop_where_guiding_ends() -> None:
    driven = Driven()
    driven.step.stop("Stop.")
    driven.step.guided("close")
    driven.tick()
    ended = driven.tick(hand=GripperReading(0.05)).command.gripper
    assert ended is not None
    assert (ended.width_m, ended.speed_m_s) == (0.05, 0.0)


@pytest.mark.parametrize("asked", ["open", "close", "toggle"])
def test_a_guide_moves_no_fingers_that_cannot_be_read(asked: GripperAsk) -> None:
    driven = Driven()
    driven.step.stop("Stop.")
    driven.step.guided(asked)
    assert driven.tick(hand=None).command.gripper is None


def test_held_for_a_second_it_opens_a_disengaged_gripper_as_long_as_it_is_held() -> None:
    held = GripperReading(0.012, holding=True)
    driven = Driven()
    driven.tick("close")
    driven.step.stop("Stop.")
    asked = driven.hold(1.0, held)
    assert all(one is not None and one.speed_m_s == 0.0 for one in asked)
    opening = driven.hold(0.2, held)[-1]
    assert opening == GripperCommand(WIDE, 0.05, 20.0)
    let_go = driven.tick(hand=GripperReading(0.03)).command.gripper
    assert let_go is not None
    assert (let_go.width_m, let_go.speed_m_s) == (0.03, 0.0)
    assert driven.step.stopped is not None


@pytest.mark.parametrize("interruption", ["let go", "stale", "closed", "enabled"])
def test_what_opens_a_gripper_must_be_held_without_a_break(interruption: str) -> None:
    driven = Driven()
    driven.tick("close")
    driven.step.stop("Stop.")
    driven.hold(0.9)
    if interruption == "enabled":
        driven.step.enable()
    elif interruption == "let go":
        driven.tick()
    elif interruption == "stale":
        for _ in range(7):
            driven.tick(age_s=1.0, opens=True)
    else:
        driven.tick("close", opens=False)
    asked = driven.hold(0.9)
    assert all(one is not None and one.speed_m_s == 0.0 for one in asked)


def test_inputs_that_are_missing_for_a_moment_let_the_fingers_wait_and_do_not_begin_the_second_anew() -> None:
    driven = Driven()
    driven.tick("close")
    driven.step.stop("Stop.")
    driven.hold(0.99)
    missing = [driven.tick(age_s=0.06, opens=True).command.gripper for _ in range(4)]
    assert all(one is not None and one.speed_m_s == 0.0 for one in missing)
    opening = driven.tick(opens=True).command.gripper
    assert opening == GripperCommand(WIDE, 0.05, 20.0)


def test_a_clock_that_jumps_is_no_second_of_holding() -> None:
    driven = Driven()
    driven.tick("close")
    driven.step.stop("Stop.")
    driven.hold(0.5)
    for _ in range(60):
        next(driven._tick)
    assert all(one is not None and one.speed_m_s == 0.0 for one in driven.hold(0.9))


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
    pace=st.floats(0.0, 1.0),
)
def test_every_command_is_finite_and_within_the_limits(
    ticks: list[tuple[GripperAsk | None, float, bool, bool, bool]], speed: float, force: float, pace: float
) -> None:
    gripper = GripperFilter(HAND, SafetyConfig(gripper_speed=speed, gripper_force=force))
    for number, (asked, width, holding, engaged, other) in enumerate(ticks):
        gripper.tick()
        gripper.saw(GripperReading(width, holding))
        gripper.ask(asked, engaged=engaged)
        if other:
            gripper.guided(asked)
        command = gripper.command(0.2 * number, pace, engaged=engaged, opens=other)
        if command is not None:
            assert 0.0 <= command.width_m <= WIDE
            assert 0.0 <= command.speed_m_s <= pace * min(speed, HAND.speed_m_s)
            assert 0.0 < command.force_n <= min(force, HAND.force_n)
