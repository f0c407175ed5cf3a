"""What holds for every arm, simulated or real, whatever its time is."""

from functools import cache
from typing import get_args

import numpy as np
import pytest

from latentarm.arms.contract import Arm, ArmPhase
from latentarm.core.types import Command
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot

_panda = cache(panda)


class ArmLaws:
    """Tests that need no time to pass; `ArmContract` and `RealArmContract` add those that do.

    Override `new_arm` and `arm`, and `robot` if the arm is not for a Panda.
    """

    @pytest.fixture
    def robot(self) -> Robot:
        """The robot that the arm is made for."""
        return _panda()

    @pytest.fixture
    def new_arm(self) -> Arm:
        """An arm that has just been made."""
        raise NotImplementedError("override the fixture `new_arm`")

    @pytest.fixture
    def arm(self, new_arm: Arm) -> Arm:
        """The same arm, connected and enabled."""
        raise NotImplementedError("override the fixture `arm`")

    def test_its_status_says_why_it_takes_no_commands(self, new_arm: Arm) -> None:
        assert new_arm.status().phase == "off"
        assert new_arm.status().reason
        with pytest.raises(RuntimeError, match="connected"):
            new_arm.read()
        new_arm.connect()
        status = new_arm.status()
        assert status.phase in get_args(ArmPhase)
        assert not status.takes_commands
        assert status.reason

    def test_what_it_measures_has_the_robots_joints_and_gripper(self, arm: Arm, robot: Robot) -> None:
        reading = arm.read()
        felt = () if reading.external_torque is None else (reading.external_torque,)
        for figures in (reading.q, reading.dq, *felt):
            assert figures.shape == (robot.dof,)
            assert np.isfinite(figures).all()
        assert (reading.gripper is None) == (robot.gripper is None)
        if reading.gripper is not None and robot.gripper is not None:
            assert -1e-3 <= reading.gripper.width_m <= robot.gripper.width_m + 1e-3

    @pytest.mark.parametrize("wrong", ["short", "nan", "matrix"])
    def test_a_command_that_no_filter_would_send_is_an_error(
        self, arm: Arm, robot: Robot, wrong: str
    ) -> None:
        n = robot.dof
        velocity = {"short": np.zeros(n - 1), "nan": np.full(n, np.nan), "matrix": np.zeros((1, n))}[wrong]
        with pytest.raises(ValueError, match=f"{n} finite joint velocities"):
            arm.send(Command(velocity, duration_s=0.02))
