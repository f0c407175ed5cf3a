"""What the tests of real arms stand on: the arm, what answers in its place, and waiting in real time."""

import multiprocessing
import os
import signal
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from typing import Self, final

import numpy as np
import pytest

from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.real import RealArm
from latentarm.control.clock import MonotonicClock
from latentarm.core.types import Command, FloatArray, GripperCommand
from latentarm.robots.robot import Robot
from latentarm.testing.arm_laws import ArmLaws

_PERIOD_S = 0.01


@final
class Driving:
    """Another process that drives an arm at a velocity (n,), rad/s, by commands of ``hold_s``."""

    def __init__(self, address: str, robot: Robot, velocity: FloatArray, hold_s: float) -> None:
        context = multiprocessing.get_context("spawn")
        self._reading, writing = context.Pipe(duplex=False)
        arguments = (address, robot, velocity, hold_s, writing)
        self._process = context.Process(target=_drive, args=arguments, daemon=True)

    def __enter__(self) -> Self:
        self._process.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Kill it, if it still lives."""
        self.kill()

    @property
    def driving(self) -> bool:
        """Whether it has begun to send commands; EOFError where it has failed."""
        return self._reading.poll(0)

    def kill(self) -> None:
        """End it at once; it can do nothing any more."""
        if self._process.pid is not None and self._process.is_alive():
            os.kill(self._process.pid, signal.SIGKILL)
        self._process.join()


def _drive(address: str, robot: Robot, velocity: FloatArray, hold_s: float, told: Connection) -> None:
    clock = MonotonicClock()
    arm = make_real_arm(address, robot, clock.now_s)
    arm.connect()
    arm.enable()
    while not arm.status().takes_commands:
        clock.wait_until(clock.now_s() + _PERIOD_S)
    told.send_bytes(b"driving")
    while True:
        arm.send(Command(velocity, duration_s=hold_s))
        clock.wait_until(clock.now_s() + _PERIOD_S)


HOLD_S = 0.05  # how long a command of these tests lasts, as on the page, s
_UNTESTED = "The driver's stops are not tested: override {}, or skip there with the reason."
RATE_HZ = 100.0  # how often they send one, if the arm takes so many


class StandIn(ABC):
    """What answers in place of an arm, as it is from the arm's side of the network.

    It overrides what it can do. Where an arm has no emergency stop or no faults, the method skips the test
    with the reason (`pytest.skip`): a driver whose stops are not tested fails.
    """

    @abstractmethod
    def positions(self) -> FloatArray:
        """(n,), where the joints are, as the arm itself knows it, rad."""

    def press_emergency_stop(self) -> None:
        """Somebody presses the button on the arm."""
        pytest.fail(_UNTESTED.format("press_emergency_stop and release_emergency_stop"))

    def release_emergency_stop(self) -> None:
        """The button is released."""
        pytest.fail(_UNTESTED.format("press_emergency_stop and release_emergency_stop"))

    def break_down(self) -> None:
        """The arm stops by itself with a fault that can be recovered from, as after a collision."""
        pytest.fail(_UNTESTED.format("break_down"))

    def push(self, by: FloatArray) -> None:
        """Somebody pushes the joints by hand, by (n,) rad; they move where the arm lets them."""
        pytest.skip("nobody can push this stand-in")

    def cut(self) -> None:
        """Nothing passes between the driver and the arm any more, as when a cable is pulled out."""
        pytest.fail(_UNTESTED.format("cut and repair"))

    def repair(self) -> None:
        """The cable is plugged in again."""
        pytest.fail(_UNTESTED.format("cut and repair"))


class RealArmRig(ArmLaws):
    """Fixtures and helpers of `latentarm.testing.real_arms.RealArmContract`, where they are described."""

    pytestmark = pytest.mark.clock
    tolerance_rad = 2e-3
    settling_s = 0.5
    waits_s = 5.0
    arrives = (0.3, 1.3)
    gripper_s = 5.0

    @pytest.fixture
    def stand_in(self) -> StandIn:
        """What answers in place of the arm; it may serve all tests of the class."""
        raise NotImplementedError("override the fixture `stand_in`")

    @pytest.fixture
    def make(self, stand_in: StandIn, robot: Robot) -> Callable[[], RealArm]:
        """Makes a driver for the stand-in that is not connected, with the clock of `MonotonicClock`."""
        raise NotImplementedError("override the fixture `make`")

    @pytest.fixture
    def refused(self) -> Callable[[], RealArm]:
        """Makes a driver for something that must be refused, such as an arm with old firmware."""
        pytest.skip("nothing is refused here")

    @pytest.fixture
    def address(self) -> str:
        """The address of the stand-in, to be driven from another process; its scheme is registered."""
        pytest.fail(_UNTESTED.format("the fixture address"))

    @pytest.fixture
    def new_arm(self, make: Callable[[], RealArm]) -> Iterator[RealArm]:
        arm = make()
        yield arm
        arm.close()

    @pytest.fixture
    def arm(self, new_arm: RealArm) -> RealArm:
        new_arm.connect()
        self._enable(new_arm)
        return new_arm

    @pytest.fixture
    def velocity(self, robot: Robot, stand_in: StandIn) -> FloatArray:
        """(n,), away from the nearest limits at different slow speeds, rad/s."""
        middle = (robot.limits.lower + robot.limits.upper) / 2
        return np.linspace(0.05, 0.1, robot.dof) * np.where(stand_in.positions() < middle, 1.0, -1.0)

    def _opens_by(self, arm: RealArm, width_m: float) -> bool:
        found = arm.read().gripper
        return found is not None and abs(found.width_m - width_m) < 0.1 * width_m

    def _command(self, velocity: FloatArray, robot: Robot) -> Command:
        """A long command, with one for the gripper where there is one."""
        gripper = None if robot.gripper is None else GripperCommand(0.0, 0.05, 5.0)
        return Command(velocity, duration_s=1.0, gripper=gripper)

    def _enable(self, arm: RealArm) -> None:
        arm.enable()
        self._wait_for(lambda: arm.status().takes_commands)

    def _drive(self, arm: RealArm, velocity: FloatArray, for_s: float) -> None:
        period_s = 1.0 / min(arm.spec.rate_hz, RATE_HZ)
        until_s = time.monotonic() + for_s
        while time.monotonic() < until_s:
            arm.send(Command(velocity, duration_s=max(HOLD_S, 2.5 * period_s)))
            arm.read()
            time.sleep(period_s)

    def _at_rest(self, arm: RealArm, stand_in: StandIn) -> FloatArray:
        """Where the arm has come to rest, as soon after the last command as it must, (n,), rad."""
        time.sleep(HOLD_S + (arm.spec.stops_after_s or 0.0) + self.settling_s)
        return self._still(stand_in, stand_in.positions())

    def _still(self, stand_in: StandIn, where: FloatArray) -> FloatArray:
        time.sleep(0.15)
        found = stand_in.positions()
        np.testing.assert_allclose(found, where, atol=self.tolerance_rad)
        return found

    def _wait_for(self, what: Callable[[], bool], within_s: float | None = None) -> None:
        end_s = time.monotonic() + (within_s or self.waits_s)
        while not what():
            assert time.monotonic() < end_s, "it never came to that"
            time.sleep(0.005)
