"""What a page asks of the gripper: it counts once however it travels, and never late."""

from itertools import groupby

import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.arms.contract import INPUT_BUDGET_S
from latentarm.control.clock import SimulatedClock
from latentarm.web.arm_process.page_inputs import PageInputs
from latentarm.web.protocol.orders import AskedGripper, Enable, Given
from latentarm.web.protocol.shared_memory import LatestSlot

TICK_S = 0.01


class Way:
    """From the server to the loop: a slot that keeps the newest input alone."""

    def __init__(self):
        self.clock = SimulatedClock()
        self.slot = LatestSlot(1024)
        self.inputs = PageInputs(self.slot, self.clock, 2, 0.05, INPUT_BUDGET_S, lambda notice: None)
        self.nonces = [self.inputs.issue_nonce()]
        self.newest = None
        self.sequence = 0

    def send(self, asked=None, nonce=None, driver=1):
        """As the server does: with every input goes the newest thing asked."""
        self.sequence += 1
        stamps = {"seq": self.sequence, "nonce": nonce or self.nonces[-1]}
        if asked:
            self.newest = AskedGripper(ask=asked, **stamps)
        fields = {"driver": driver, "u": (0.0, 0.0), "latched": False, "source": "switch"}
        told = Given(**fields, **stamps, gripper=self.newest)
        self.slot.write(told.model_dump_json().encode())

    def tick(self):
        """What the loop is given, where it is fresh."""
        found, age_s = self.inputs.latest(self.clock.now_s())
        self.nonces.append(self.inputs.issue_nonce())
        self.clock.wait_until(self.clock.now_s() + TICK_S)
        return found.gripper if age_s < TICK_S / 2 else None


def changes(asked):
    return [one for one, _ in groupby(filter(None, asked))]


@pytest.fixture
def way():
    way = Way()
    way.send()
    way.tick()  # its first input begins a driver's turn, who has no nonce yet
    return way


def test_an_ask_that_the_next_input_replaces_counts_once(way):
    way.send("close")
    way.send()
    assert way.tick() == "close"
    for _ in range(5):
        way.send()
        assert way.tick() is None
    assert way.inputs.devices == {"switch"}


def test_an_ask_that_was_late_does_not_count_later(way):
    old = way.nonces[-1]
    way.clock.wait_until(way.clock.now_s() + INPUT_BUDGET_S + TICK_S)
    way.nonces.append(way.inputs.issue_nonce())
    way.send("close", nonce=old)
    assert way.tick() is None
    for _ in range(5):
        way.send()
        assert way.tick() is None


def test_what_one_driver_asked_does_not_count_for_the_next(way):
    way.send("close")
    way.send(driver=2)
    assert way.tick() is None
    way.send(driver=2)
    assert way.tick() is None


@given(st.lists(st.sampled_from(["ask", "input", "late ask", "tick"]), max_size=40))
def test_however_inputs_are_lost_the_gripper_goes_where_it_was_last_asked_to_in_time(events):
    way = Way()
    way.send()
    way.tick()
    late = way.nonces[-1]
    way.clock.wait_until(way.clock.now_s() + INPUT_BUDGET_S + TICK_S)
    way.nonces.append(way.inputs.issue_nonce())
    seen, expected, waiting, asks = [], [], None, 0
    for event in [*events, "tick"]:
        if event == "ask":
            waiting = ("open", "close")[asks % 2]
            asks += 1
            way.send(waiting)
        elif event == "input":
            way.send()
        elif event == "late ask":
            # What was asked before it, and was not read yet, is lost with it: the newest ask counts.
            waiting = None
            way.send("toggle", nonce=late)
        else:
            seen.append(way.tick())
            expected.append(waiting)
            waiting = None
    assert changes(seen) == changes(expected)


def test_the_gripper_moves_as_it_is_asked_and_only_while_the_arm_is_enabled(desk):
    asks = {0.5: "close", 2.0: "toggle", 3.0: "open"}
    enabled_s, stopped_s = 1.0, 2.7

    def tick(now_s):
        if abs(now_s - enabled_s) < 0.005:
            desk.order(Enable(driver=1, stops=desk.channel.stop.version))
        if abs(now_s - stopped_s) < 0.005:
            desk.channel.stop.write(b"Stop.")
        asked = next((ask for at_s, ask in asks.items() if abs(now_s - at_s) < 0.005), None)
        desk.give(0.0, 0.0, gripper=asked)

    desk.each_tick = tick
    desk.run(4.0)
    at = {round(report.time_s, 2): report.gripper for report in desk.reports}
    assert at[1.99].width_m == desk.setup.task.robot.gripper.width_m
    assert at[1.99].closing is None
    # A toggle closes what is open, slowly enough to be watched; where the arm is stopped it stays.
    assert at[2.6].closing
    assert 0.04 < at[2.6].width_m < 0.06
    assert at[3.9].width_m == at[2.9].width_m > 0.04
