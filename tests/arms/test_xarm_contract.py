"""The laws of real arms, for an xArm: the manufacturer's library against the stand-in for its controller."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from arms.xarm_rig import xarm7
from arms.xarm_server import XArmServer, serving
from latentarm.arms.catalogue import make_real_arm
from latentarm.arms.real import RealArm
from latentarm.control.clock import MonotonicClock
from latentarm.core.types import FloatArray
from latentarm.robots.robot import Robot
from latentarm.testing.real_arms import RealArmContract, StandIn


class _Controller(StandIn):
    def __init__(self, server: XArmServer) -> None:
        self.server = server

    def positions(self) -> FloatArray:
        return np.array(self.server.do("state")["q"])

    def press_emergency_stop(self) -> None:
        self.server.do("press")

    def release_emergency_stop(self) -> None:
        self.server.do("release")

    def break_down(self) -> None:
        self.server.do("fail", error=31)

    def push(self, by: FloatArray) -> None:
        self.server.do("push", by=by.tolist())

    def cut(self) -> None:
        self.server.do("cut")

    def repair(self) -> None:
        self.server.do("reconnect")


@pytest.mark.slow  # 22 laws in real time
class TestXArm(RealArmContract):
    settling_s = 0.1

    @pytest.fixture(scope="class")
    @classmethod
    def stand_in(cls) -> Iterator[_Controller]:
        with serving(q=xarm7().home.tolist()) as server:
            yield _Controller(server)

    @pytest.fixture
    def robot(self) -> Robot:
        return xarm7()

    @pytest.fixture
    def address(self, stand_in: _Controller) -> str:
        return stand_in.server.address()

    @pytest.fixture
    def make(self, address: str, robot: Robot) -> Callable[[], RealArm]:
        return lambda: make_real_arm(address, robot, MonotonicClock().now_s)

    @pytest.fixture
    def refused(self, robot: Robot) -> Iterator[Callable[[], RealArm]]:
        with serving(firmware=[1, 7, 2]) as old:
            yield lambda: make_real_arm(old.address(), robot, MonotonicClock().now_s)
