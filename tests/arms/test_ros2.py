"""The driver of arms behind ROS 2: over the rosbridge protocol, with the published watchdog at the arm."""

import json
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any
from unittest.mock import Mock, call

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbridge_server import GRIPPER_JOINT, RosbridgeServer, Setup, load_watchdog, silent_port

from latentarm.arms.address import parse_address
from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.real import RealArm
from latentarm.arms.ros2 import link
from latentarm.arms.ros2.gripper import Ros2Gripper
from latentarm.arms.ros2.joint_states import ClockJumpedError, JointStates, StampClock, UnusableStatesError
from latentarm.arms.ros2.options import read_options
from latentarm.arms.ros2.session import parse_state
from latentarm.control.clock import MonotonicClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand
from latentarm.robots.panda import panda
from latentarm.robots.planar import planar
from latentarm.robots.robot import Robot
from latentarm.testing.real_arms import RealArmContract

WHOLE = f"ros2://arm?controller=c&gripper_joint={GRIPPER_JOINT}"


def made(address: str, robot: Robot) -> RealArm:
    return make_real_arm(address, robot, MonotonicClock().now_s)


def drive(arm: RealArm, velocity: Any, for_s: float = 0.3, gripper: GripperCommand | None = None) -> None:
    until_s = time.monotonic() + for_s
    while time.monotonic() < until_s:
        arm.send(Command(velocity, 0.05, gripper=gripper))
        time.sleep(0.01)


def wait_for(what: Callable[[], bool]) -> None:
    until_s = time.monotonic() + 5.0
    while not what():
        assert time.monotonic() < until_s, "it never came to that"
        time.sleep(0.005)


@pytest.mark.slow  # 22 laws in real time
class TestRos2Arm(RealArmContract):
    settling_s = 0.15
    gripper_s = 2.0
    # After 0.5 s of driving: 0.05 s of the last command, 0.07 s of the watchdog's patience, half its ramp.
    arrives = (0.3, 1.4)

    @pytest.fixture(scope="class")
    @classmethod
    def stand_in(cls) -> Iterator[RosbridgeServer]:
        with RosbridgeServer(panda()) as server:
            yield server

    @pytest.fixture
    def make(self, stand_in: RosbridgeServer, robot: Robot) -> Callable[[], RealArm]:
        return lambda: made(stand_in.address, robot)

    @pytest.fixture
    def address(self, stand_in: RosbridgeServer) -> str:
        return stand_in.address

    @pytest.fixture
    def refused(self, robot: Robot) -> Iterator[Callable[[], RealArm]]:
        with RosbridgeServer(robot, Setup(watchdog=False)) as server:
            yield lambda: made(server.address, robot)


def test_guiding_by_hand_is_refused_with_what_to_do_at_the_arm(the_panda: Robot) -> None:
    arm = made(WHOLE, the_panda)
    with pytest.raises(UserError, match=r"^This arm is not released over ROS 2: .* record here .*\.$"):
        arm.guide()


# Marked by hand: the contract above marks its own tests.
clock = pytest.mark.clock


@clock
def test_a_trajectory_controller_is_driven_as_a_velocity_controller_is(the_panda: Robot) -> None:
    with RosbridgeServer(the_panda, Setup(kind="trajectory")) as server:
        arm = made(server.address, the_panda)
        with arm:
            arm.enable()
            wait_for(lambda: arm.status().takes_commands)
            velocity = np.linspace(0.05, 0.1, 7)
            before, began_s = server.positions(), time.monotonic()
            drive(arm, velocity, 0.5)
            share = (server.positions() - before) / (velocity * (time.monotonic() - began_s))
            assert ((share > 0.5) & (share < 1.2)).all(), share
            server.watchdog = None  # killed: the last trajectory ends at rest
            time.sleep(0.25)
            rested = server.positions()
            time.sleep(0.2)
            np.testing.assert_allclose(server.positions(), rested, atol=1e-6)
            wait_for(lambda: arm.status().phase == "fault")
            assert "watchdog" in arm.status().reason


@pytest.fixture(scope="module")
def odd_server() -> Iterator[RosbridgeServer]:
    with RosbridgeServer(panda()) as server:
        yield server


REFUSALS: dict[str, tuple[Callable[[RosbridgeServer], None], str]] = {
    "no watchdog": (lambda s: setattr(s, "watchdog", None), "start latentarm_watchdog.py"),
    "old watchdog": (lambda s: setattr(s, "setup", replace(s.setup, version=0)), "has version 0"),
    "frozen stamps": (lambda s: setattr(s, "states_as", "repeated"), "repeat one moment"),
    "no joint states": (lambda s: setattr(s, "states_as", "none"), "No joint states"),
    "missing joint": (lambda s: setattr(s, "states_as", "missing"), "lack joint7"),
    "not a number": (lambda s: setattr(s, "states_as", "nan"), "not a finite number"),
    "inactive controller": (lambda s: setattr(s.arm, "active", False), "is inactive"),
    "slow joint states": (lambda s: setattr(s, "setup", replace(s.setup, rate_hz=10.0)), "40 are needed"),
}


@clock
@pytest.mark.parametrize("what", list(REFUSALS))
def test_what_cannot_be_driven_is_refused_in_one_sentence(
    odd_server: RosbridgeServer, the_panda: Robot, what: str
) -> None:
    happens, said = REFUSALS[what]
    happens(odd_server)
    before = odd_server.positions()
    try:
        refusals = made(odd_server.address, the_panda).look().refusals
        assert any(said in refusal for refusal in refusals), refusals
        assert all(refusal.endswith(".") and "\n" not in refusal for refusal in refusals)
    finally:
        odd_server.setup, odd_server.states_as, odd_server.arm.active = Setup(), "good", True
        odd_server.start_watchdog()
    assert (odd_server.positions() == before).all()


@clock
def test_another_robot_and_another_client_are_refused(odd_server: RosbridgeServer, the_panda: Robot) -> None:
    five = planar(5)
    address = odd_server.address.partition("&gripper")[0]
    with pytest.raises(UserError, match="choose the robot that the arm is"):
        made(address, five).connect()
    with made(odd_server.address, the_panda) as first:
        first.enable()
        wait_for(lambda: first.status().takes_commands)
        drive(first, np.full(7, 0.05), 0.2)
        with pytest.raises(UserError, match="Another client drives the arm"):
            made(odd_server.address, the_panda).connect()
        drive(first, np.full(7, 0.05), 0.2)
        assert first.status().phase == "moving", first.status().reason  # nothing has changed for the first


@clock
def test_a_client_that_was_cut_off_finds_the_arm_in_other_hands(
    odd_server: RosbridgeServer, the_panda: Robot
) -> None:
    with made(odd_server.address, the_panda) as first:
        first.enable()
        wait_for(lambda: first.status().takes_commands)
        odd_server.cut()
        time.sleep(1.2)  # the first's session has expired
        assert first.status().phase == "fault"
        watchdog = odd_server.watchdog
        known = {"op": "claim", "session": "x" * 32, "sequence": 0, "age": 0.0}
        watchdog.heard(json.dumps({**known, "seen": time.monotonic()}), time.monotonic())
        odd_server.repair()
        before = odd_server.positions()
        beating = {**known, "op": "heartbeat"}
        for sequence in range(1, 100):
            first.recover()
            first.enable()
            first.send(Command(np.full(7, 0.2), 0.1))
            now_s = time.monotonic()
            odd_server._do(
                lambda s=sequence, t=now_s: watchdog.heard(
                    json.dumps({**beating, "sequence": s, "seen": t}), t
                )
            )
            time.sleep(0.03)
            if "Another client" in first.status().reason:
                break
        assert first.status().reason == "Another client drives the arm: end it there first."
        assert (odd_server.positions() == before).all()


@clock
@pytest.mark.parametrize("by_s", [30.0, -30.0])
def test_a_clock_that_is_set_stops_the_arm_until_the_person_recovers_it(
    odd_server: RosbridgeServer, the_panda: Robot, by_s: float
) -> None:
    with made(odd_server.address, the_panda) as arm:
        arm.enable()
        wait_for(lambda: arm.status().takes_commands)
        drive(arm, np.full(7, -0.05), 0.2)
        odd_server.jump_clock(by_s)
        wait_for(lambda: arm.status().phase == "fault")
        assert "clock" in arm.status().reason
        time.sleep(0.15)
        rested = odd_server.positions()
        drive(arm, np.full(7, -0.05), 0.2)
        np.testing.assert_allclose(odd_server.positions(), rested, atol=1e-6)
        arm.recover()
        wait_for(lambda: arm.status().phase == "disabled")
        before = arm.read()
        wait_for(lambda: arm.read().sequence > before.sequence)
        assert 0.0 <= MonotonicClock().now_s() - arm.read().time_s < 0.1


@clock
def test_the_gripper_holds_what_it_closes_on_and_says_when_it_failed(
    odd_server: RosbridgeServer, the_panda: Robot
) -> None:
    with made(odd_server.address, the_panda) as arm:
        arm.enable()
        wait_for(lambda: arm.status().takes_commands)
        rest = np.zeros(7)

        def reason_after(width_m: float) -> str:
            drive(arm, rest, 0.05, GripperCommand(width_m, 0.1, 20.0))
            return arm.status().reason

        odd_server.gripper.thing_m = 0.03
        drive(arm, rest, 1.2, GripperCommand(0.0, 0.1, 20.0))
        found = arm.read().gripper
        assert found is not None
        assert found.holding
        assert found.width_m == pytest.approx(0.03, abs=1e-3)
        goals = odd_server.goals
        arm.stop()
        drive(arm, rest, 0.1, GripperCommand(0.0, 0.1, 20.0))
        assert odd_server.goals == goals, "what is held is neither let go nor grasped again"
        odd_server.gripper.thing_m, odd_server.gripper_fails = None, True
        wait_for(lambda: "gripper" in reason_after(0.08))
        assert arm.status().takes_commands
        odd_server.gripper_fails = False
        wait_for(lambda: reason_after(0.07) == "")


def test_a_gripper_that_was_halted_on_its_way_goes_on_when_it_is_asked_again(the_panda: Robot) -> None:
    to_ros = Mock()
    to_ros.send_goal.side_effect = ["first", "second"]
    assert the_panda.gripper is not None
    gripper = Ros2Gripper(to_ros, read_options(parse_address(WHOLE), the_panda), the_panda.gripper)
    closing = GripperCommand(0.0, 0.1, 20.0)
    for command in (closing, closing, GripperCommand(0.0, 0.0, 20.0), closing, closing):
        gripper.command(command)
    assert to_ros.send_goal.call_count == 2
    assert to_ros.cancel_goal.call_args_list == [call("/gripper_controller/gripper_cmd", "first")]


def test_what_is_not_rosbridge_is_named(the_panda: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link, "CONNECTING_S", 0.3)
    with silent_port() as port, pytest.raises(UserError, match="is not rosbridge"):
        made(f"ros2://127.0.0.1:{port}?controller=c&gripper_joint=f", the_panda).look()
    with pytest.raises(UserError, match="start rosbridge there"):
        made(f"ros2://127.0.0.1:{port}?controller=c&gripper_joint=f", the_panda).connect()


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("ros2://arm", "needs the name of the arm's controller"),
        (WHOLE + "&kind=effort", "velocity or trajectory, not effort"),
        (WHOLE + "&speed=1", "does not know the option speed"),
        (WHOLE + "&joints=a,b", "7 different names"),
        (WHOLE + "&joints=a,a,b,c,d,e,f", "7 different names"),
        (WHOLE + "&states=joint states", "states of --arm ros2 must be a name"),
        (WHOLE + "&gripper_open=wide", "gripper_open of --arm ros2 must be a number"),
        (WHOLE + "&gripper_open=0", "must be different"),
        ("ros2://arm?controller=c", "gripper_joint=NAME, as `ros2 topic echo --once /joint_states` shows"),
    ],
)
def test_options_are_checked(the_panda: Robot, address: str, said: str) -> None:
    with pytest.raises(UserError, match=said):
        read_options(parse_address(address), the_panda)


def test_options_have_the_usual_names_of_ros(the_panda: Robot) -> None:
    options = read_options(parse_address(WHOLE), the_panda)
    assert (options.where, options.controller, options.kind) == ("arm:9090", "/c", "velocity")
    assert (options.states, options.gripper) == ("/joint_states", "/gripper_controller/gripper_cmd")
    assert (options.joints, options.gripper_open) == (the_panda.joint_names, 0.08)


def message(names: list[str], **entries: Any) -> dict[str, Any]:
    figures = [0.1 * k for k in range(len(names))]
    stamp = {"stamp": {"sec": 5, "nanosec": 500_000_000}}
    return {"header": stamp, "name": names, "position": figures, "velocity": figures, **entries}


@given(st.permutations(["elbow", "shoulder", "wrist", "finger"]))
def test_joints_are_found_by_name_in_any_order(names: list[str]) -> None:
    states = JointStates(("shoulder", "elbow", "wrist"), "finger")
    found = states.take(message(names))
    assert found is not None
    expected = [0.1 * names.index(name) for name in ("shoulder", "elbow", "wrist")]
    assert found.q.tolist() == expected == found.dq.tolist()
    assert states.gripper == 0.1 * names.index("finger")
    assert found.stamp_s == 5.5


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (message(["a"]), "lack b"),
        (message(["a", "b", "b"]), "twice"),
        (message(["a", "b"], velocity=[]), "no velocity for each joint"),
        (message(["a", "b"], position=[0.0, None]), "not a finite number"),
        (message(["a", "b"], position=[0.0, math.inf]), "not a finite number"),
        (message(["a", "b"], position=[0.0, "1"]), "not a finite number"),
        (message(["a", "b"], header={}), "no stamp"),
        (message(["a", "b"], name="ab"), "no names"),
    ],
)
def test_joint_states_that_cannot_be_used_say_why(wrong: dict[str, Any], said: str) -> None:
    with pytest.raises(UnusableStatesError, match=said):
        JointStates(("a", "b"), "").take(wrong)


def test_joint_states_of_a_gripper_alone_are_no_fault() -> None:
    states = JointStates(("a", "b"), "finger")
    assert states.take(message(["finger"])) is None
    assert states.gripper == 0.0


@given(st.lists(st.floats(0.0, 0.09), min_size=1, max_size=50), st.floats(-1e9, 1e9))
def test_readings_are_dated_in_order_and_never_in_the_future(delays: list[float], ahead_s: float) -> None:
    clock, before = StampClock(), -math.inf
    for count, delay_s in enumerate(delays):
        measured_s = 10.0 + 0.1 * count
        found = clock.time_of(measured_s + ahead_s, measured_s + delay_s)
        assert found is not None
        assert before < found <= measured_s + delay_s
        assert found >= measured_s - 1e-6
        before = found


def test_a_repeated_stamp_is_nothing_new_and_one_that_jumps_is_told_once() -> None:
    clock = StampClock()
    assert clock.time_of(5.0, 100.0) == 100.0
    assert clock.time_of(5.0, 100.01) is None
    for stamp_s in (4.0, 9.0):
        with pytest.raises(ClockJumpedError):
            clock.time_of(stamp_s, 100.02)
        assert clock.time_of(stamp_s + 0.01, 100.03) == pytest.approx(100.03)


DOG = load_watchdog()
GOOD = json.loads(DOG.Watchdog(DOG.Arm("/c", "velocity", (DOG.Joint("a", 1, 1),))).state(1.0))


@given(st.sampled_from(sorted(GOOD)), st.one_of(st.none(), st.text(max_size=3), st.booleans(), st.just([1])))
def test_a_state_of_the_watchdog_is_read_whole_or_not_at_all(entry: str, value: Any) -> None:
    text = json.dumps({**GOOD, entry: value})
    try:
        state = parse_state(text)
    except ValueError:
        return
    assert isinstance(state.joints, tuple)
    assert isinstance(state.reason, str)
    assert isinstance(state.stop_pressed, bool)


@pytest.mark.parametrize("text", [None, "", "[]", "{}", "[" * 10_000, '{"latentarm_watchdog": true}'])
def test_what_is_no_state_is_an_error(text: object) -> None:
    with pytest.raises(ValueError):
        parse_state(text)
