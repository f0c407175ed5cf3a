"""LeRobot's own SO-101 class and the servos' own SDK, over a serial port with simulated servos behind it.

They run in an environment that has LeRobot; elsewhere one slow test runs this file there.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from arms.feetech_bus import ACCELERATION, CELSIUS, GOAL, MIN_POSITION, TORQUE, FeetechBus
from latentarm.arms.address import parse_address
from latentarm.arms.contract import INPUT_BUDGET_S, Arm, check_arm
from latentarm.arms.lerobot.arm import STOPS_AFTER_S, LerobotArm
from latentarm.arms.lerobot.keeper import now_s
from latentarm.arms.shadow import ShadowArm
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand
from latentarm.robots.catalogue import load_robot
from latentarm.robots.gripper import Gripper
from latentarm.robots.limits_file import parse_limits
from latentarm.robots.robot import Robot
from latentarm.testing.real_arms import RealArmContract, StandIn
from lerobot_environment import lerobot_python, plugin_environment

pytestmark = pytest.mark.slow

HERE = Path(__file__)
MOTORS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
STEPS_PER_RAD = 4095 / (2.0 * np.pi)
VELOCITY = np.array([0.3, -0.2, 0.1, 0.2, -0.1])

LAG_RAD = 0.03
"""How far the servos still go once their goals stand still: their lag at the speeds used here."""


@pytest.mark.skipif(find_spec("lerobot") is not None, reason="runs here itself")
def test_in_an_environment_with_lerobot(tmp_path: Path) -> None:
    python = lerobot_python()
    done = subprocess.run(
        [python, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(HERE)],
        cwd=HERE.parents[2],
        env=plugin_environment(tmp_path),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-5000:]


needs_lerobot = pytest.mark.skipif(find_spec("lerobot") is None, reason="needs LeRobot 0.6")


def _xml() -> str:
    """An arm with the joints of an SO-101."""
    bodies = "".join(
        f'<body pos="0 0 0.1"><joint name="{name}" axis="{axis}" range="-1.7 1.7"/>'
        f'<geom type="capsule" size="0.02 0.04" mass="0.1"/>'
        for name, axis in zip(MOTORS[:5], ("0 0 1", "0 1 0", "0 1 0", "0 1 0", "0 0 1"), strict=True)
    )
    world = f'<worldbody>{bodies}<site name="tool"/>{"</body>" * 5}</worldbody>'
    return f'<mujoco model="so101"><compiler angle="radian"/>{world}</mujoco>'


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    path = tmp_path_factory.mktemp("model") / "so101.xml"
    path.write_text(_xml())
    figures = {"velocity_rad_per_s": 2.0, "acceleration_rad_per_s2": 10.0, "jerk_rad_per_s3": 500.0}
    limits = {"tool_speed_m_per_s": 0.5, "joints": dict.fromkeys(MOTORS[:5], figures)}
    arm = load_robot(str(path), None, parse_limits(limits, "limits"))
    return replace(arm, gripper=Gripper((), width_m=0.08, speed_m_s=0.1, force_n=10.0))


@pytest.fixture(scope="module")
def calibration(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("calibration") / "bench.json"
    ranges = {"drive_mode": 0, "homing_offset": 0, "range_min": 1000, "range_max": 3000}
    file.write_text(json.dumps({name: {"id": index + 1, **ranges} for index, name in enumerate(MOTORS)}))
    return file


@pytest.fixture
def bus() -> Iterator[FeetechBus]:
    with FeetechBus() as bus:
        yield bus


@pytest.fixture(scope="module")
def ports(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the serial port of each test's bus appears under one name, as with a rule of udev."""
    return tmp_path_factory.mktemp("dev") / "so101"


@pytest.fixture(scope="module")
def kept(robot: Robot, calibration: Path, ports: Path) -> LerobotArm:
    """One arm for all tests: LeRobot takes many seconds to import."""
    return LerobotArm(robot, _address(ports, calibration), now_s)


@pytest.fixture
def arm(kept: LerobotArm, bus: FeetechBus, ports: Path) -> Iterator[LerobotArm]:
    ports.unlink(missing_ok=True)
    ports.symlink_to(bus.port)
    yield kept
    kept.close()


def _address(port: Path, calibration: Path):
    return parse_address(f"lerobot://so101_follower?port={port}&calibration={calibration}")


def _wait(true: Callable[[], bool], within_s: float = 5.0) -> None:
    until_s = time.monotonic() + within_s
    while not true():
        assert time.monotonic() < until_s
        time.sleep(0.01)


def _enabled(arm: LerobotArm) -> LerobotArm:
    arm.connect()
    arm.enable()
    _wait(lambda: arm.status().takes_commands)
    return arm


def _drive(arm: Arm, ticks: int, gripper: GripperCommand | None = None) -> float:
    """How long it was driven, s."""
    begun_s = time.monotonic()
    for tick in range(ticks):
        arm.send(Command(VELOCITY, duration_s=0.05, gripper=gripper))
        time.sleep(max(begun_s + 0.01 * (tick + 1) - time.monotonic(), 0.0))
    return time.monotonic() - begun_s


def _places(bus: FeetechBus) -> np.ndarray:
    return np.array(bus.places()[:5]) / STEPS_PER_RAD


def _stands_still(bus: FeetechBus) -> None:
    before = _places(bus)
    time.sleep(0.3)
    np.testing.assert_allclose(_places(bus), before, atol=1e-3)


@needs_lerobot
def test_it_says_what_it_is(arm: LerobotArm, robot: Robot) -> None:
    check_arm(arm.spec, robot)
    assert not arm.spec.simulated
    assert arm.spec.input_budget_s <= INPUT_BUDGET_S


@needs_lerobot
def test_looking_and_connecting_change_nothing(arm: LerobotArm, bus: FeetechBus) -> None:
    found = arm.look()
    assert not found.refusals
    told = {fact.name: fact.value for fact in found.facts}
    assert told["firmware"] == "3.10"
    assert "7.4 V" in told["supply"]
    assert "shoulder_pan ±87.9°" in told["calibrated to"]
    assert "shoulder_pan -4.2°" in told["positions"] or "shoulder_pan 0.0°" in told["positions"]
    arm.connect()
    time.sleep(0.3)
    arm.close()
    assert not bus.written()


@needs_lerobot
def test_its_shadow_takes_commands_and_tells_the_motors_nothing(arm: LerobotArm, bus: FeetechBus) -> None:
    shadow = ShadowArm(arm)
    shadow.connect()
    shadow.enable()
    assert shadow.status().takes_commands
    _drive(shadow, 50, GripperCommand(0.0, speed_m_s=0.05, force_n=5.0))
    shadow.stop()
    shadow.close()
    assert not bus.written()


@needs_lerobot
def test_enabling_does_not_move_it_though_the_old_goal_is_elsewhere(arm: LerobotArm, bus: FeetechBus) -> None:
    bus.place(1500.0)
    _enabled(arm)
    time.sleep(0.3)
    assert all(bus.powered())
    assert all(abs(at - 1500.0) < 1.5 for at in bus.places())


@needs_lerobot
def test_it_goes_where_the_velocities_lead_and_stops_when_they_end(arm: LerobotArm, bus: FeetechBus) -> None:
    _enabled(arm)
    before = arm.read().q
    span_s = _drive(arm, 100) + 0.04
    time.sleep(0.3)
    np.testing.assert_allclose(arm.read().q - before, VELOCITY * span_s, atol=0.01)
    assert arm.status().phase == "ready"
    _stands_still(bus)


@needs_lerobot
@pytest.mark.parametrize("when", ["standing", "enabling", "moving"])
def test_late_answers_to_another_question_are_no_positions(
    arm: LerobotArm, bus: FeetechBus, when: str
) -> None:
    """LeRobot takes them for encoder step 0: far out of range, and the gripper closed."""
    bus.place(1500.0)
    if when == "enabling":
        arm.connect()
        bus.answer_late(1)
        arm.enable()
        time.sleep(0.5)
    else:
        _enabled(arm)
        if when == "moving":
            _drive(arm, 30)
        time.sleep(0.3)
        before = bus.places()
        bus.answer_late(3)
        if when == "moving":
            _drive(arm, 10)
            arm.stop()
        time.sleep(0.5)
        assert np.abs(np.array(bus.places()) - before).max() < (60 if when == "moving" else 3)
    told = [int.from_bytes(data[:2], "little") for _, _, address, data in bus.written() if address == GOAL]
    assert min(told) > 1400
    assert max(told) < 1700


@needs_lerobot
def test_an_arm_is_not_ready_while_a_motor_has_no_torque(arm: LerobotArm, bus: FeetechBus) -> None:
    bus.cut_power(3)
    arm.connect()
    arm.enable()
    time.sleep(1.0)
    status = arm.status()
    assert status.phase == "fault"
    assert "elbow_flex stays without torque" in status.reason


@needs_lerobot
def test_stop_stops_it_and_it_goes_on_afterwards(arm: LerobotArm, bus: FeetechBus) -> None:
    _enabled(arm)
    _drive(arm, 30)
    arm.send(Command(VELOCITY, duration_s=5.0))
    arm.stop()
    at = _places(bus)
    time.sleep(0.3)
    assert np.abs(_places(bus) - at).max() < LAG_RAD
    _stands_still(bus)
    _drive(arm, 30)
    assert np.abs(_places(bus) - at).max() > 0.05


@needs_lerobot
@pytest.mark.parametrize("how", ["disable", "close"])
def test_it_stays_under_power_and_moves_no_more(arm: LerobotArm, bus: FeetechBus, how: str) -> None:
    _enabled(arm)
    _drive(arm, 20)
    getattr(arm, how)()
    time.sleep(0.2)
    arm.send(Command(VELOCITY, duration_s=1.0))
    _stands_still(bus)
    assert all(bus.powered())
    arm.connect()
    arm.send(Command(VELOCITY, duration_s=1.0))
    _stands_still(bus)


@needs_lerobot
def test_the_gripper_closes(arm: LerobotArm, bus: FeetechBus) -> None:
    _enabled(arm)
    _wait(lambda: arm.read().gripper is not None)
    assert arm.read().gripper.width_m == pytest.approx(0.04, abs=0.001)
    _drive(arm, 50, GripperCommand(0.0, speed_m_s=0.05, force_n=5.0))
    assert arm.read().gripper.width_m == pytest.approx(0.015, abs=0.005)
    time.sleep(1.0)
    assert bus.places()[5] == pytest.approx(1000.0, abs=20.0)


@needs_lerobot
def test_it_holds_its_position_when_the_process_next_to_it_is_killed(
    arm: LerobotArm, bus: FeetechBus
) -> None:
    _enabled(arm)
    _drive(arm, 50)
    at = _places(bus)
    os.kill(arm._process.pid, signal.SIGKILL)
    time.sleep(0.3)
    assert np.abs(_places(bus) - at).max() < LAG_RAD
    assert arm.status().phase == "fault"
    _stands_still(bus)
    assert all(bus.powered())
    arm.close()
    _enabled(arm)


DRIVEN = """
import sys, time
import numpy as np
sys.path.insert(0, sys.argv[1])
from arms.test_lerobot import VELOCITY, MOTORS, _address, _enabled, _xml
from latentarm.arms.lerobot.arm import LerobotArm
from latentarm.arms.lerobot.keeper import now_s
from latentarm.robots.catalogue import load_robot
from latentarm.core.types import Command
arm = _enabled(LerobotArm(load_robot(sys.argv[2]), _address(sys.argv[3], sys.argv[4]), now_s))
print("driving", flush=True)
while True:
    arm.send(Command(VELOCITY, duration_s=0.05))
    time.sleep(0.01)
"""


@needs_lerobot
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
def test_it_stops_when_the_process_that_drives_it_is_killed_or_stalls(
    bus: FeetechBus, robot: Robot, calibration: Path, how: signal.Signals
) -> None:
    model = str(robot.model_path)
    with subprocess.Popen(
        [sys.executable, "-c", DRIVEN, str(HERE.parents[1]), model, bus.port, str(calibration)],
        stdout=subprocess.PIPE,
        text=True,
    ) as driver:
        try:
            assert driver.stdout is not None
            assert driver.stdout.readline() == "driving\n"
            time.sleep(0.5)
            assert bus.written()[-1][2] == GOAL
            os.kill(driver.pid, how)
            ended_s = time.monotonic()
            time.sleep(0.5)
            goals = [(at_s, number, data) for at_s, number, address, data in bus.written() if address == GOAL]
            final = {number: data for _, number, data in goals}
            last_change_s = max(at_s for at_s, number, data in goals if data != final[number])
            assert last_change_s - ended_s < 0.05 + STOPS_AFTER_S
            _stands_still(bus)
            assert all(bus.powered())
        finally:
            driver.kill()


@needs_lerobot
def test_a_bus_that_falls_silent_is_a_fault_that_can_be_recovered_from(
    arm: LerobotArm, bus: FeetechBus
) -> None:
    _enabled(arm)
    _drive(arm, 20)
    bus.silence(True)
    _wait(lambda: arm.status().phase == "fault")
    assert "bus does not answer" in arm.status().reason
    before = arm.read().time_s
    time.sleep(0.3)
    assert arm.read().time_s == before
    bus.silence(False)
    _wait(lambda: arm.read().time_s > before)
    arm.recover()
    _wait(lambda: arm.status().phase == "disabled")
    _stands_still(bus)


@needs_lerobot
def test_readings_are_new_after_the_bus_has_stood_still(arm: LerobotArm, bus: FeetechBus) -> None:
    _enabled(arm)
    bus.stand_still(2.0)
    assert arm.status().phase == "fault"
    ended_s = arm.read().time_s
    _wait(lambda: arm.read().time_s > ended_s)
    arm.recover()
    _wait(lambda: arm.status().phase == "disabled")
    arm.guide()
    _wait(lambda: not any(bus.powered()[:5]))
    before, begun_s = arm.read().q, time.monotonic()
    bus.push([100.0] * 6)
    _wait(lambda: np.abs(arm.read().q - before).max() > 0.1)
    assert time.monotonic() - begun_s < 0.1


@needs_lerobot
def test_a_motor_that_lets_go_is_a_fault_by_name(arm: LerobotArm, bus: FeetechBus) -> None:
    _enabled(arm)
    bus.put(2, TORQUE, 0)
    _wait(lambda: arm.status().phase == "fault")
    assert "shoulder_lift has switched its torque off" in arm.status().reason


@needs_lerobot
@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ("hot", "elbow_flex is at 66 °C"),
        ("range", "calibration"),
        ("slow", "elbow_flex is under power and set"),
    ],
)
def test_what_looking_refuses_connecting_refuses(
    arm: LerobotArm, bus: FeetechBus, wrong: str, says: str
) -> None:
    if wrong == "hot":
        bus.put(3, CELSIUS, 66)
    elif wrong == "range":
        bus.put(3, MIN_POSITION, 1200, size=2)
    else:
        bus.put(3, ACCELERATION, 10)
        bus.put(3, TORQUE, 1)
    (refusal,) = arm.look().refusals
    assert says in refusal
    with pytest.raises(UserError) as refused:
        arm.connect()
    assert str(refused.value) == refusal
    assert not bus.written()


@needs_lerobot
def test_a_missing_motor_or_port_is_one_sentence(arm: LerobotArm, bus: FeetechBus, ports: Path) -> None:
    bus.remove(4)
    for ask in (arm.look, arm.connect):
        with pytest.raises(UserError, match=r"^The motors wrist_flex of .* do not answer on .*cables\.$"):
            ask()
    ports.unlink()
    with pytest.raises(UserError, match="cannot be used for so101_follower: see that the arm is connected"):
        arm.connect()


@needs_lerobot
def test_a_robot_with_other_joints_is_refused(calibration: Path, bus: FeetechBus) -> None:
    from latentarm.robots.panda import panda

    arm = LerobotArm(panda(), _address(Path(bus.port), calibration), now_s)
    (refusal,) = arm.look().refusals
    assert "choose the robot that the arm is" in refusal
    with pytest.raises(UserError, match="choose the robot"):
        arm.connect()


@needs_lerobot
@pytest.mark.parametrize("kind", ["no_such_robot", "lekiwi_client"])
def test_what_is_no_arm_on_a_bus_is_refused(robot: Robot, calibration: Path, kind: str) -> None:
    address = parse_address(f"lerobot://{kind}?port=/dev/null&calibration={calibration}")
    with pytest.raises(UserError, match="so101_follower"):
        LerobotArm(robot, address, now_s)


class SimulatedServos(StandIn):
    """An arm of simulated servos, whose joints are at zero in the middle of their range."""

    def __init__(self, bus: FeetechBus) -> None:
        self._bus = bus

    def positions(self) -> np.ndarray:
        """See the base class."""
        return _places(self._bus) - 2000.0 / STEPS_PER_RAD

    def press_emergency_stop(self) -> None:
        pytest.skip("an SO-101 has no emergency stop")

    def break_down(self) -> None:
        """A motor lets go."""
        if not self._bus.powered()[1]:
            pytest.skip("the motors of an arm that is guided have let go already")
        self._bus.put(2, TORQUE, 0)

    def push(self, by: np.ndarray) -> None:
        """See the base class."""
        self._bus.push([*(by * STEPS_PER_RAD).tolist(), 0.0])
        time.sleep(0.1)  # until it has been read

    def cut(self) -> None:
        """See the base class."""
        self._bus.silence(True)

    def repair(self) -> None:
        """See the base class."""
        self._bus.silence(False)


@needs_lerobot
class TestLerobotArm(RealArmContract):
    """One driver for all tests, because LeRobot takes many seconds to import."""

    @pytest.fixture(scope="class")
    @classmethod
    def bus(cls) -> Iterator[FeetechBus]:
        with FeetechBus() as bus:
            yield bus

    @pytest.fixture(scope="class")
    @classmethod
    def only(cls, robot: Robot, calibration: Path, bus: FeetechBus) -> LerobotArm:
        return LerobotArm(robot, _address(Path(bus.port), calibration), now_s)

    @pytest.fixture(scope="class")
    @classmethod
    def robot(cls, robot: Robot) -> Robot:
        return robot

    @pytest.fixture
    def stand_in(self, bus: FeetechBus) -> SimulatedServos:
        return SimulatedServos(bus)

    @pytest.fixture
    def address(self, bus: FeetechBus, calibration: Path) -> str:
        return f"lerobot://so101_follower?port={bus.port}&calibration={calibration}"

    @pytest.fixture
    def make(self, only: LerobotArm) -> Callable[[], LerobotArm]:
        return lambda: only

    @pytest.fixture
    def refused(self, only: LerobotArm, bus: FeetechBus) -> Iterator[Callable[[], LerobotArm]]:
        bus.put(3, CELSIUS, 66)
        yield lambda: only
        bus.put(3, CELSIUS, 30)
