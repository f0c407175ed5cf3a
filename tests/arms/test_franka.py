"""The driver of a Franka against franky-sim, over the arm's own protocol."""

import dataclasses
import time

import numpy as np
import pytest
from franka_server import START, FrankaStandIn

from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.contract import check_arm
from latentarm.arms.franka import pace
from latentarm.arms.franka.link import has_realtime
from latentarm.arms.shadow import ShadowArm
from latentarm.control.clock import MonotonicClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command, FloatArray, GripperCommand
from latentarm.robots.catalogue import load_robot
from latentarm.robots.panda import fr3
from latentarm.robots.robot import Robot
from latentarm.testing.real_arms import RealArmContract, StandIn

pytest.importorskip("franky", reason="franky-control is not installed")
pytest.importorskip("franky_sim", reason="franky-sim is not installed: latentarm[franka-sim]")

pytestmark = [pytest.mark.clock, pytest.mark.slow]

HOST = "127.0.7.1"
ADDRESS = f"patient://{HOST}?realtime=ignore"
VELOCITY = np.array([0.1, 0.05, -0.05, 0.1, 0.05, -0.1, 0.1])
TREMBLE_RAD = 1e-3
"""A joint that has moved no farther than this stands still."""


@pytest.fixture(scope="module", autouse=True)
def patience():
    """Undo the changes of the patient driver after these tests."""
    least = pace._LEAST
    yield
    pace._LEAST = least


@pytest.fixture(scope="module")
def server():
    with FrankaStandIn(HOST) as running:
        yield running


@pytest.fixture
def stand_in(server):
    return server


@pytest.fixture
def new_arm(server):
    driver = make_real_arm(ADDRESS, fr3(), MonotonicClock().now_s)
    yield driver
    driver.close()


@pytest.fixture
def arm(new_arm):
    new_arm.connect()
    new_arm.enable()
    return new_arm


def drive(arm, stand_in, velocity, for_s, gripper=None):
    """For so long by the stand-in's clock, which may pass at a fraction of ours."""
    end_s, give_up_s = stand_in.time_s() + for_s, time.monotonic() + 30.0
    while stand_in.time_s() < end_s:
        assert time.monotonic() < give_up_s, "the stand-in is too slow"
        arm.send(Command(velocity, duration_s=0.05, gripper=gripper))
        time.sleep(0.01)


def becomes(arm, phase, within_s=10.0, recovering=False):
    end_s = time.monotonic() + within_s
    while arm.status().phase != phase:
        if recovering:
            arm.recover()
        assert time.monotonic() < end_s, arm.status()
        time.sleep(0.005)
    return arm.status()


def at_rest(stand_in):
    stand_in.wait(0.3)
    before = stand_in.positions()
    stand_in.wait(0.1)
    np.testing.assert_allclose(stand_in.positions(), before, atol=TREMBLE_RAD)
    return before


def test_it_says_what_it_found_and_moves_nothing(new_arm, stand_in):
    before = stand_in.positions()
    check_arm(new_arm.spec, fr3())
    found = new_arm.look()
    assert not found.refusals
    names = {fact.name: fact.value for fact in found.facts}
    assert names["arm"] == "Franka Research 3"
    assert names["mode"] == "Idle"
    assert {"payload", "clock", "round trip", "hand"} <= set(names)
    np.testing.assert_allclose(stand_in.positions(), before, atol=TREMBLE_RAD)
    assert new_arm.status().phase == "off"


@pytest.mark.parametrize(
    ("address", "robot", "said"),
    [
        (ADDRESS, "panda", "name the arm's own model with --robot"),
        (f"franka://{HOST}", "fr3", "no realtime kernel"),
        ("franka://127.0.7.250?realtime=ignore", "fr3", "There is no Franka at 127.0.7.250"),
    ],
)
def test_what_looking_refuses_connecting_refuses(stand_in, address, robot, said):
    if "realtime" in said and "realtime" not in address and has_realtime():
        pytest.skip("this computer has a realtime kernel")
    driver = make_real_arm(address, load_robot(robot), MonotonicClock().now_s)
    try:
        sentences = driver.look().refusals
    except UserError as error:
        sentences = (str(error),)
    assert any(said in sentence for sentence in sentences)
    with pytest.raises(UserError) as error:
        driver.connect()
    assert str(error.value) in sentences
    assert driver.status().phase == "off"


def test_its_shadow_takes_commands_and_tells_it_none(new_arm, stand_in):
    at, before = stand_in.positions(), len(stand_in.commands())
    shadow = ShadowArm(new_arm)
    shadow.connect()
    shadow.enable()
    assert shadow.status().takes_commands
    drive(shadow, stand_in, VELOCITY, 0.5, gripper=GripperCommand(0.02, 0.05, force_n=5.0))
    shadow.stop()
    shadow.close()
    # franky sets the collision thresholds when it connects, and asks for the model.
    assert set(stand_in.commands()[before:]) <= {"kConnect", "kSetCollisionBehavior", "kGetRobotModel"}
    np.testing.assert_allclose(stand_in.positions(), at, atol=TREMBLE_RAD)


def test_a_robot_with_its_joints_elsewhere_is_refused(stand_in):
    chain = fr3().chain
    raised = np.array(chain.offset)
    raised[0, 2, 3] += 0.1
    robot = dataclasses.replace(fr3(), name="fr3_on_a_box", chain=dataclasses.replace(chain, offset=raised))
    with pytest.raises(UserError, match=r"joints of fr3_on_a_box are not where the arm's are"):
        make_real_arm(ADDRESS, robot, MonotonicClock().now_s).connect()


def test_a_long_command_ends_before_the_end_of_a_joint(arm, stand_in):
    velocity = np.array([0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0])
    arm.send(Command(velocity, duration_s=100.0))
    becomes(arm, "ready", within_s=60.0)
    rested = at_rest(stand_in)[3]
    assert START[3] + 0.5 < rested < fr3().limits.upper[3]


def test_the_hand_goes_where_it_is_told_and_can_be_told_otherwise(arm, stand_in):
    still = np.zeros(7)
    drive(arm, stand_in, still, 0.1, GripperCommand(0.0, 0.1, 20.0))
    drive(arm, stand_in, still, 0.1, GripperCommand(0.06, 0.1, 20.0))
    end_s = time.monotonic() + 30.0
    while abs(arm.read().gripper.width_m - 0.06) > 0.003:
        assert time.monotonic() < end_s, arm.read().gripper
        drive(arm, stand_in, still, 0.05, GripperCommand(0.06, 0.1, 20.0))
    assert not arm.read().gripper.holding
    assert arm.status().takes_commands


def test_a_clock_that_is_not_ours_is_refused_and_stops_the_arm(new_arm, stand_in, monkeypatch):
    new_arm.connect()
    new_arm.enable()
    becomes(new_arm, "ready")
    # Whatever the stand-in's clock does on this machine is too fast now.
    monkeypatch.setattr(pace, "_LEAST", 0.0)
    monkeypatch.setattr(pace, "_MOST", 1e-3)
    end_s = time.monotonic() + 30.0
    while "The arm's clock passes" not in new_arm.status().reason:
        assert time.monotonic() < end_s, new_arm.status()
        drive(new_arm, stand_in, VELOCITY, 0.05)
    assert not new_arm.status().takes_commands
    at_rest(stand_in)
    new_arm.close()
    (sentence,) = new_arm.look().refusals
    assert "s in each second of this computer, so its commands would end" in sentence
    with pytest.raises(UserError, match="The arm's clock passes"):
        new_arm.connect()


def test_it_says_what_pushes_it_with_the_sign_of_the_push(arm, stand_in):
    by = np.array([0.0, 0.3, 0.0, 0.3, 0.0, 0.0, 0.0])
    assert np.abs(arm.read().external_torque).max() == 0.0
    stand_in.begin_push(by)
    stand_in.wait(0.3)
    felt = arm.read().external_torque
    stand_in.push(np.zeros(7))
    assert felt.shape == (7,)
    assert (felt[[1, 3]] > 2.0).all()
    assert np.abs(felt[[0, 2, 4, 5, 6]]).max() < 1.0


class Served(StandIn):
    """The stand-in as the contract knows it."""

    def __init__(self, server: FrankaStandIn) -> None:
        self._server = server

    def positions(self) -> FloatArray:
        return self._server.positions()

    def press_emergency_stop(self) -> None:
        self._server.press_emergency_stop()

    def release_emergency_stop(self) -> None:
        self._server.release_emergency_stop()

    def break_down(self) -> None:
        self._server.break_down()

    def push(self, by: FloatArray) -> None:
        self._server.push(by)

    def cut(self) -> None:
        self._server.cut()

    def repair(self) -> None:
        self._server.repair()


class TestFranka(RealArmContract):
    tolerance_rad = TREMBLE_RAD
    settling_s = 0.3
    arrives = (0.1, 1.3)  # franky-sim is slower than real time on a small machine

    @pytest.fixture
    def robot(self) -> Robot:
        return fr3()

    @pytest.fixture
    def stand_in(self, server):
        return Served(server)

    @pytest.fixture
    def velocity(self, robot, stand_in):
        middle = (robot.limits.lower + robot.limits.upper) / 2
        return 0.3 * np.where(stand_in.positions() < middle, 1.0, -1.0)

    @pytest.fixture
    def make(self, server):
        return lambda: make_real_arm(ADDRESS, fr3(), MonotonicClock().now_s)

    @pytest.fixture
    def refused(self, server):
        return lambda: make_real_arm(ADDRESS, load_robot("panda"), MonotonicClock().now_s)

    @pytest.fixture
    def address(self, server):
        return ADDRESS
