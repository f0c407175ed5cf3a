"""The driver of xArms against a stand-in for their controller, in real time."""

import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from arms.xarm_rig import drive, enable, slow, wait_for, xarm7
from arms.xarm_server import CONTROL, PLAIN, STATUS, TIMED, XArmServer, serving
from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.real import RealArm
from latentarm.control.clock import MonotonicClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand

pytestmark = pytest.mark.clock

ROBOT = xarm7()
HOME = ROBOT.home.tolist()
READS = {1, 13, 15, 42, 44, 124}
"""Registers that change nothing; 124 carries the gripper's."""


@pytest.fixture(scope="module")
def server() -> Iterator[XArmServer]:
    with serving(q=HOME) as running:
        yield running


@pytest.fixture
def arm(server: XArmServer) -> Iterator[RealArm]:
    made = make_real_arm(server.address(), ROBOT, MonotonicClock().now_s)
    made.connect()
    enable(made)
    yield made
    server.do("set", frozen=False, nan=False, silent=False, clock_s=0.0, answer_s=0.0)
    server.do("reconnect")
    server.do("client", mode=4, state=4)
    made.close()


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "old firmware": ({"firmware": [1, 7, 9]}, "firmware 1.7.9 drops the duration"),
    "wrong DoF": ({"axes": 6, "kind": 6}, "xArm 6 with 6 joints"),
    "gripper on old firmware": ({"firmware": [1, 9, 0]}, "the gripper would hold up"),
    "no gripper": ({"has_gripper": False}, "gripper has not answered"),
    "unknown load": ({"load_kg": 0.0}, "does not know what the arm carries"),
    "load is no number": ({"load_kg": float("nan")}, "payload is no number"),
    "collision detection off": ({"collision_sensitivity": 0}, "collision detection is off"),
    "slower than stated": ({"speed": 1.0}, r"and 57\.3°/s for the arm \(and 6 joints more\)"),
    "outside the limits": ({"q": [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0]}, "Joint 'joint4' is at -57.3°"),
}


FITTING: dict[str, Any] = {
    "firmware": [2, 3, 0],
    "axes": 7,
    "kind": 7,
    "has_gripper": True,
    "load_kg": 0.8,
    "collision_sensitivity": 3,
    "speed": 3.14,
    "q": HOME,
}


@pytest.mark.parametrize("why", list(REFUSED))
def test_an_arm_that_cannot_be_driven_is_refused_in_one_sentence(server: XArmServer, why: str) -> None:
    unfitting, said = REFUSED[why]
    server.do("set", **unfitting)
    server.do("requests")
    timed = "firmware" not in unfitting
    arm = make_real_arm(
        server.address(joints_port=server.ports[TIMED if timed else PLAIN]), ROBOT, MonotonicClock().now_s
    )
    before = server.do("state")["q"]
    try:
        with pytest.raises(UserError, match=said) as refusal:
            arm.connect()
        sentence = str(refusal.value)
        assert sentence.endswith(".")
        assert ". " not in sentence
        if why == "no gripper":
            with pytest.raises(UserError, match=said):
                arm.look()
        else:
            assert arm.look().refusals == (sentence,)
        assert set(server.do("requests")) <= READS
        assert server.do("state")["q"] == before
    finally:
        server.do("set", **FITTING)


FAULTS: dict[str, tuple[Callable[[XArmServer], object], str, str]] = {
    "emergency stop": (lambda s: s.do("press"), "emergency_stop", "button on the control box is pressed"),
    "collision": (lambda s: s.do("fail", error=31), "fault", "check what the arm has hit"),
    "error of no meaning": (lambda s: s.do("fail", error=77), "fault", "error 77"),
    "frozen angles": (
        lambda s: s.do("set", frozen=True),
        "fault",
        "does not change although it was told to move",
    ),
    "angles that are no numbers": (lambda s: s.do("set", nan=True), "fault", "no numbers"),
    "no reports": (lambda s: s.do("set", silent=True), "fault", "no new joint angles"),
    "clock forward": (lambda s: s.do("set", clock_s=5.0), "fault", "jumped forward by 5 s"),
    "clock back": (lambda s: s.do("set", clock_s=-5.0), "fault", "jumped back"),
    "mode changed": (lambda s: s.do("client", mode=0), "fault", "Another program has taken over"),
    "stopped by others": (lambda s: s.do("client", state=4), "fault", "Another program has taken over"),
    "slow answers": (lambda s: s.do("set", answer_s=0.3), "fault", "has not answered for 80 ms"),
    "restart": (lambda s: s.do("restart"), "fault", "ended the connection"),
}


@pytest.mark.parametrize("fault", list(FAULTS))
def test_a_fault_stops_the_arm_with_one_sentence_and_only_enabling_moves_it_again(
    arm: RealArm, server: XArmServer, fault: str
) -> None:
    happen, phase, said = FAULTS[fault]
    velocity = slow(ROBOT)
    drive(arm, velocity, 0.1)
    happen(server)
    _drive_until_it_stops(arm)
    assert arm.status().phase == phase
    sentence = arm.status().reason
    assert said in sentence
    assert sentence.endswith(".")
    assert ". " not in sentence
    time.sleep(0.4)  # a controller that answers late may carry out its last command late
    rested = server.do("state")["q"]
    server.do("set", frozen=False, nan=False, silent=False, clock_s=0.0, answer_s=0.0)
    server.do("release")
    wait_for(lambda: arm.status().phase == "fault")
    drive(arm, velocity, 0.1)
    assert server.do("state")["q"] == rested
    arm.recover()
    wait_for(lambda: arm.status().phase == "disabled")
    drive(arm, velocity, 0.1)
    enable(arm)
    assert server.do("state")["q"] == rested
    drive(arm, velocity, 0.1)
    assert server.do("state")["q"] != rested


def _drive_until_it_stops(arm: RealArm) -> None:
    end_s = time.monotonic() + 1.0
    while arm.status().takes_commands and time.monotonic() < end_s:
        drive(arm, slow(ROBOT), 0.02)


def test_a_second_client_that_moves_an_enabled_arm_at_rest_is_stopped(
    arm: RealArm, server: XArmServer
) -> None:
    drive(arm, np.zeros(7), 0.7)
    server.do("client", velocity=[0.2] + [0.0] * 6)
    wait_for(lambda: arm.status().phase == "fault", 1.0)
    assert "without having been told to" in arm.status().reason
    time.sleep(0.05)
    assert not any(server.do("state")["v"])


def test_an_arm_whose_reported_angles_stopped_earlier_is_not_enabled(server: XArmServer) -> None:
    arm = make_real_arm(server.address(), ROBOT, MonotonicClock().now_s)
    with arm:
        server.do("set", frozen=True)
        server.do("set", q=[angle + 0.1 for angle in server.do("state")["q"]])
        before = server.do("state")
        arm.enable()
        wait_for(lambda: arm.status().phase == "fault")
        assert "differ by 0.1 rad" in arm.status().reason
        assert server.do("state")["q"] == before["q"]
        server.do("set", frozen=False, q=HOME)


def test_what_was_held_up_on_the_way_never_moves_the_arm(arm: RealArm, server: XArmServer) -> None:
    drive(arm, slow(ROBOT), 0.2)
    server.do("cut")
    drive(arm, slow(ROBOT), 0.4)
    assert arm.status().phase == "fault"
    rested = server.do("state")["q"]
    server.do("reconnect")
    time.sleep(0.3)
    assert server.do("state")["q"] == rested


def test_a_command_lasts_no_longer_than_what_is_left_of_it(arm: RealArm, server: XArmServer) -> None:
    before = np.array(server.do("state")["q"])
    arm.send(Command(np.full(7, 0.5), duration_s=0.1))
    time.sleep(0.3)
    moved = np.array(server.do("state")["q"]) - before
    assert (moved > 0.0).all()
    assert (moved <= 0.5 * (0.1 + (arm.spec.stops_after_s or 0.0))).all()
    commands = server.do("state")["commands"]
    arm.send(Command(np.full(7, 0.5), duration_s=0.001))
    time.sleep(0.1)
    assert server.do("state")["commands"] == commands


def test_a_stop_keeps_what_the_gripper_holds(arm: RealArm, server: XArmServer) -> None:
    def holds() -> bool:
        gripper = arm.read().gripper
        return gripper is not None and gripper.holding

    server.do("set", grips_at=400.0)
    try:
        arm.send(Command(np.zeros(7), 0.05, gripper=GripperCommand(0.0, 0.1, 20.0)))
        wait_for(holds)
        arm.send(Command(np.zeros(7), 0.05, gripper=GripperCommand(0.0, 0.0, 20.0)))
        time.sleep(0.5)
        assert holds()
    finally:
        server.do("set", grips_at=None)


def test_firmware_without_times_in_its_reports_is_driven_too() -> None:
    robot = xarm7(gripper=False)
    with serving(q=HOME, firmware=[1, 12, 10], load_kg=0.0) as server:
        arm = make_real_arm(server.address(load="none"), robot, MonotonicClock().now_s)
        assert not arm.look().refusals
        with arm:
            enable(arm)
            drive(arm, slow(robot), 0.4)
            np.testing.assert_allclose(arm.read().dq, 0.1, atol=0.03)
            assert MonotonicClock().now_s() - arm.read().time_s < 0.05


@pytest.fixture
def own_timeout() -> Iterator[None]:
    """The manufacturer's API changes the timeout of every socket that is made in the process afterwards."""
    before_s = socket.getdefaulttimeout()
    yield
    socket.setdefaulttimeout(before_s)


@pytest.mark.usefixtures("own_timeout")
def test_the_stand_in_is_driven_by_the_manufacturers_own_api() -> None:
    from xarm.wrapper import XArmAPI

    host = f"127.{os.getpid() % 250 + 2}.{time.time_ns() % 250}.7"
    try:
        running = XArmServer(
            q=HOME, host=host, ports={port: port for port in (CONTROL, TIMED, STATUS, PLAIN)}
        )
    except RuntimeError:
        pytest.skip("the API knows port 502 only, and this machine does not let everybody listen there")
    api = XArmAPI(host, is_radian=True, baud_checkset=False, forbid_uds=True)
    try:
        assert (api.axis, api.version_number) == (7, (2, 3, 0))
        assert (api.motion_enable(True), api.set_mode(4), api.set_state(0)) == (0, 0, 0)
        wait_for(lambda: api.mode == 4)
        assert api.vc_set_joint_velocity([0.2] * 7, duration=0.1) == 0
        time.sleep(0.3)
        moved = np.array(running.do("state")["q"]) - HOME
        np.testing.assert_allclose(moved, 0.02, atol=5e-3)
        assert not any(running.do("state")["v"])
        assert api.get_servo_angle()[1] == pytest.approx(running.do("state")["q"], abs=1e-5)
        assert api.tcp_load[0] == pytest.approx(0.8)
        assert (api.set_gripper_enable(True), api.set_gripper_mode(0)) == (0, 0)
        assert api.set_gripper_position(500, wait=True, wait_motion=False) == 0
        assert api.get_gripper_position() == (0, 500)
        assert api.set_state(4) == 0
    finally:
        api.disconnect()
        running.close()


def test_the_manufacturers_library_says_nothing_on_standard_output() -> None:
    program = "from latentarm.arms.xarm.sdk import load_sdk; load_sdk()"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == ""
