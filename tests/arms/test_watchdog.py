"""The watchdog that is published with the docs, without ROS: its decisions, in simulated time."""

import json
import os
import threading
import time
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbridge_server import load_watchdog

from latentarm.arms.contract import STOPS_AFTER_S
from latentarm.arms.ros2 import arm as driver
from latentarm.arms.ros2.session import VERSION, parse_state

dog = load_watchdog()

JOINTS = (dog.Joint("b", 1.0, 20.0), dog.Joint("a", 0.5, 10.0))
KEY, OTHER = "k" * 32, "o" * 32
ENDED_S = dog.STOPS_AFTER_S + dog.RAMP_S + dog.TICK_S


class World:
    """A watchdog with an arm that does what it is told, and clients with a network to it."""

    def __init__(self, **arm: Any) -> None:
        self.arm = dog.Arm("/controller", "velocity", JOINTS, **arm)
        self.dog = dog.Watchdog(self.arm)
        self.now_s = 100.0
        self.q = np.array([0.1, -0.2])
        self.velocity = np.zeros(2)
        self.sequence = 0
        self.follows = self.tells = self.lists = True
        self.stamp_ahead_s = 1e9
        self.active = "active"
        self.fastest = 0.0
        if self.arm.stop_topic:
            self.dog.emergency_stop(False)
        self.run(0.1)

    def tick(self) -> None:
        self.now_s += dog.TICK_S
        if self.follows:
            self.q = self.q + self.velocity * dog.TICK_S
        if self.tells:
            self.dog.joint_states(
                self.now_s + self.stamp_ahead_s, ["a", "b", "x"], [self.q[1], self.q[0], 9.0], self.now_s
            )
        if self.lists:
            self.dog.controllers([("controller", self.active, ["b/velocity", "a/velocity"])], self.now_s)
        told = self.dog.tick(self.now_s)
        if told is not None:
            self.velocity = np.array(told)
        self.fastest = max(self.fastest, float(np.abs(self.velocity).max()))

    def run(self, for_s: float) -> None:
        for _ in range(round(for_s / dog.TICK_S)):
            self.tick()

    def message(self, op: str, session: str = KEY, age_s: float = 0.0, **entries: Any) -> str:
        self.sequence += 1
        known = {"op": op, "session": session, "sequence": self.sequence, "seen": self.now_s, "age": 0.0}
        return json.dumps({**known, "seen": self.now_s - age_s, **entries})

    def say(self, op: str, session: str = KEY, age_s: float = 0.0, **entries: Any) -> None:
        self.dog.heard(self.message(op, session, age_s, **entries), self.now_s)

    def armed(self) -> "World":
        self.say("claim")
        self.say("enable", arming=1)
        assert self.state.phase == "armed", self.state
        return self

    def drive(self, for_s: float, velocity: tuple[float, ...] = (0.5, -0.25)) -> "World":
        for _ in range(round(for_s / dog.TICK_S)):
            self.say("command", arming=1, velocity=velocity, duration=0.025)
            self.tick()
        return self

    @property
    def state(self) -> Any:
        return parse_state(self.dog.state(self.now_s))


def test_the_driver_and_the_watchdog_agree() -> None:
    assert dog.VERSION == VERSION
    assert pytest.approx(driver.STOPS_AFTER_S) == dog.STOPS_AFTER_S
    assert dog.STOPS_AFTER_S <= STOPS_AFTER_S
    assert dog.RAMP_S <= 0.1
    assert driver.LONGEST_S <= dog.LONGEST_S
    assert driver.HEARTBEAT_S < dog.SILENCE_S / 3


def test_it_moves_the_arm_by_name_as_it_is_told() -> None:
    world = World().armed()
    before = world.q
    world.drive(1.0)
    np.testing.assert_allclose(world.velocity, [0.5, -0.25])
    np.testing.assert_allclose(world.q - before, [0.5, -0.25], atol=0.03)


@pytest.mark.parametrize("ending", ["silence", "heartbeats"])
def test_it_brakes_when_commands_end_and_latches_when_the_client_is_silent(ending: str) -> None:
    world = World().armed().drive(0.5)
    ended_s = world.now_s
    while world.velocity.any():
        if ending == "heartbeats":
            world.say("heartbeat")
        world.tick()
    assert world.now_s - ended_s <= 0.025 + ENDED_S
    for _ in range(50):
        if ending == "heartbeats":
            world.say("heartbeat")
        world.tick()
    assert world.state.phase == {"silence": "latched", "heartbeats": "armed"}[ending]
    # Latched, it needs the person: neither commands nor enabling move it.
    world.drive(0.3)
    world.say("enable", arming=2)
    assert world.velocity.any() == (ending == "heartbeats")


def test_it_brakes_evenly_and_in_straight_lines() -> None:
    world = World().armed().drive(0.5)
    world.say("stop")
    before, speeds = world.velocity, []
    while world.velocity.any():
        world.tick()
        speeds.append(world.velocity)
    share = np.array(speeds) / before
    np.testing.assert_allclose(share[:, 0], share[:, 1], atol=1e-12)
    assert (np.diff(share[:, 0]) <= 0.0).all()
    assert len(speeds) * dog.TICK_S <= 0.1


@given(
    late_s=st.floats(0.0, 2.0),
    velocity=st.tuples(st.floats(-1.0, 1.0), st.floats(-0.5, 0.5)),
    duration_s=st.floats(0.0, 0.5),
)
def test_however_late_a_command_arrives_it_ends_in_time(
    late_s: float, velocity: tuple[float, float], duration_s: float
) -> None:
    """What counts is when it was sent, by the watchdog's own clock: the network may do as it likes."""
    world = World().armed()
    sent_s = world.now_s
    text = world.message("command", arming=1, velocity=velocity, duration=duration_s)
    world.run(late_s)
    world.dog.heard(text, world.now_s)
    end_s = sent_s + duration_s + ENDED_S + dog.TICK_S
    while world.now_s < end_s:
        world.tick()
    assert not world.velocity.any()
    world.run(0.5)
    assert not world.velocity.any()


@pytest.mark.parametrize(
    ("velocity", "duration", "said"),
    [
        ((0.2, float("nan")), 0.02, "not 2 finite"),
        ((0.2,), 0.02, "not 2 finite"),
        (("0.2", 0.1), 0.02, "not 2 finite"),
        ((0.2, 0.6), 0.02, "a was commanded 0.6 rad/s, and the watchdog allows 0.5"),
        ((0.2, 0.1), float("inf"), "not 2 finite"),
    ],
)
def test_a_command_that_is_wrong_latches_the_arm(velocity: Any, duration: float, said: str) -> None:
    world = World().armed().drive(0.3)
    world.say("command", arming=1, velocity=velocity, duration=duration)
    assert world.state.phase == "latched"
    assert said in world.state.reason
    world.drive(0.2)
    assert not world.velocity.any()
    world.say("recover")
    assert world.state.phase == "disabled"
    world.drive(0.2)
    assert not world.velocity.any()
    world.say("enable", arming=1)
    world.drive(0.2)
    assert world.velocity.any()


def test_what_was_heard_before_is_not_heard_again() -> None:
    world = World().armed()
    old = [world.message("command", arming=1, velocity=(0.5, 0.2), duration=0.5) for _ in range(3)]
    world.say("stop")
    for text in old:
        world.dog.heard(text, world.now_s)
    world.run(0.2)
    assert world.fastest == 0.0


def test_a_command_from_before_the_arm_was_enabled_again_does_not_count() -> None:
    world = World().armed()
    world.say("disable")
    world.run(0.05)
    world.say("enable", arming=2)
    world.drive(0.2)  # of arming 1
    assert world.fastest == 0.0


def test_only_one_client_drives_until_it_has_gone() -> None:
    world = World().armed().drive(0.3)
    world.say("claim", OTHER)
    world.say("enable", OTHER, arming=1)
    world.say("stop", OTHER)
    world.drive(0.1)
    assert world.velocity.any(), "nobody else can even stop it through the watchdog"
    assert world.state.owner == dog.digest(KEY)
    world.run(dog.EXPIRY_S + 0.5)
    assert not world.velocity.any()
    assert world.state.phase == "free"
    world.say("claim", OTHER)
    assert (world.state.owner, world.state.phase) == (dog.digest(OTHER), "disabled")
    world.fastest = 0.0
    world.drive(0.3)  # of the first
    world.run(0.3)
    assert world.fastest == 0.0


def test_old_messages_neither_claim_nor_enable_nor_keep_the_arm() -> None:
    world = World()
    world.say("claim", age_s=1.0)
    assert world.state.phase == "free"
    world.armed().drive(0.2)
    for _ in range(100):  # a network that had stood still lets everything through at once, seconds later
        world.say("heartbeat", age_s=5.0)
        world.say("command", age_s=5.0, arming=1, velocity=(0.5, 0.0), duration=0.5)
        world.tick()
    assert world.state.phase in ("latched", "free")
    assert not world.velocity.any()


def _clock_back(world: World) -> None:
    world.stamp_ahead_s -= 10.0


def _clock_ahead(world: World) -> None:
    world.stamp_ahead_s += 10.0


@pytest.mark.parametrize(
    ("happens", "said"),
    [
        (lambda w: setattr(w, "follows", False), "does not move as it is commanded"),
        (lambda w: setattr(w, "tells", False), "joint states have ended"),
        (lambda w: setattr(w, "active", "inactive"), "controller controller is inactive"),
        (lambda w: setattr(w, "lists", False), "controller manager does not answer"),
        (lambda w: w.dog.publishers(2), "Another node publishes"),
        (lambda w: w.dog.emergency_stop(True), "emergency stop"),
        (lambda w: w.dog.unguarded(), "second process has ended"),
        (_clock_back, "clock of the joint states"),
        (_clock_ahead, "clock of the joint states"),
    ],
)
def test_what_goes_wrong_about_the_arm_latches_it(happens: Any, said: str) -> None:
    world = World(stop_topic="/stop").armed().drive(0.5)
    happens(world)
    world.drive(1.3)
    assert not world.velocity.any()
    assert world.state.phase == "latched"
    assert said in world.state.reason
    assert world.state.reason.endswith(".")
    assert "\n" not in world.state.reason


def test_it_is_not_armed_before_it_knows_that_no_stop_is_pressed() -> None:
    world = World(stop_topic="/stop")
    world.dog = dog.Watchdog(world.arm)
    world.run(0.2)
    world.say("claim")
    world.say("enable", arming=1)
    assert world.state.phase == "disabled"
    assert "/stop" in world.state.reason


def test_joints_in_another_order_than_the_controllers_are_refused() -> None:
    world = World()
    world.lists = False
    world.dog.controllers([("controller", "active", ["a/velocity", "b/velocity"])], world.now_s)
    world.say("claim")
    world.say("enable", arming=1)
    assert "in this order" in world.state.reason


@given(st.lists(st.text(max_size=30), max_size=5))
def test_no_noise_moves_it(texts: list[str]) -> None:
    world = World().armed()
    for text in texts:
        world.dog.heard(text, world.now_s)
        world.tick()
    assert world.fastest == 0.0


_OPS = ("claim", "enable", "command", "stop", "disable", "recover", "release", "heartbeat", "x")


@given(
    st.lists(
        st.tuples(
            st.sampled_from(_OPS),
            st.sampled_from([KEY, OTHER]),
            st.integers(0, 3),
            st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)),
            st.integers(0, 30),
        ),
        max_size=40,
    )
)
def test_whatever_is_said_speeds_stay_in_limits_and_it_rests_at_the_end(said: list[Any]) -> None:
    world = World()
    for op, session, arming, velocity, ticks in said:
        world.say(op, session, arming=arming, velocity=velocity, duration=0.5)
        for _ in range(ticks):
            before = world.velocity
            world.tick()
            assert (np.abs(world.velocity) <= [1.0, 0.5]).all()
            slower = np.abs(world.velocity) <= np.abs(before)
            allowed = np.array([20.0, 10.0]) * 2 * dog.TICK_S
            assert (slower | (np.abs(world.velocity - before) <= allowed + 1e-9)).all()
    world.run(1.0)
    assert not world.velocity.any()


def test_a_trajectory_goes_on_from_the_one_before_and_always_ends_at_rest() -> None:
    targets = dog.Targets()
    first = targets.points((0.5, 0.0), (1.0, 2.0), 10.0)
    second = targets.points((0.5, 0.0), (0.9, 2.0), 10.01)
    assert first[0][0] == pytest.approx([1.0 + 0.5 * dog.AHEAD_S, 2.0])
    assert second[0][0][0] - first[0][0][0] == pytest.approx(0.005)
    assert second[-1][1] == [0.0, 0.0]
    later = targets.points((0.0, 0.0), (3.0, 2.0), 11.0)
    assert later[0][0] == pytest.approx([3.0, 2.0])


@pytest.mark.parametrize(("newest", "zeros"), [("MOVING", True), ("RESTING", False)])
def test_the_second_process_sends_zeros_when_the_watchdog_is_killed_in_motion(
    newest: str, zeros: bool
) -> None:
    reading, writing = os.pipe()
    sent: list[float] = []
    thread = threading.Thread(target=dog.guard, args=(reading, lambda: sent.append(time.monotonic())))
    os.write(writing, getattr(dog, newest))
    thread.start()
    os.close(writing)
    thread.join(5.0)
    os.close(reading)
    assert not thread.is_alive()
    assert bool(sent) == zeros


def test_its_command_line_says_what_it_guards() -> None:
    line = "--controller /c --kind velocity --joint j2 0.5 2 --joint j1 0.6 3 --stop-topic /s"
    arm, options = dog.arm_of(line.split())
    assert arm.joints == (dog.Joint("j2", 0.5, 2.0), dog.Joint("j1", 0.6, 3.0))
    assert (arm.stop_topic, arm.publishers, options.states) == ("/s", 2, "/joint_states")
    for wrong in (line + " --joint j2 1 1", line.replace("0.5", "0"), line.replace("velocity", "x")):
        with pytest.raises(SystemExit):
            dog.arm_of(wrong.split())
