"""Contract tests of simulated arms."""

from functools import cache

import numpy as np
import pytest

from latentarm.arms.catalogue import ArmFactory
from latentarm.arms.contract import SimulatedArm
from latentarm.errors import UserError
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot
from latentarm.types import Command, FloatArray

DT_S = 0.02


_panda = cache(panda)


class ArmContract:
    """Tests of an arm.

    Override the fixture ``make``, and ``robot`` if the arm is not for a Panda::

        class TestTheirArm(ArmContract):
            @pytest.fixture
            def make(self):
                return TheirArm

    Attributes:
        tolerance_rad: allowed distance from where the commands lead, rad; larger for an arm with inertia.
        settling_s: how long it may take to come to rest, s.
    """

    tolerance_rad = 1e-9
    settling_s = 0.0

    @pytest.fixture
    def make(self) -> ArmFactory:
        """What makes the arm."""
        raise NotImplementedError("override the fixture `make`")

    @pytest.fixture
    def robot(self) -> Robot:
        """The robot that the arm is made for."""
        return _panda()

    @pytest.fixture
    def arm(self, make: ArmFactory, robot: Robot) -> SimulatedArm:
        """An arm at home that has just been made."""
        arm = make(robot, robot.home)
        assert isinstance(arm, SimulatedArm), "these tests let time pass, so they are for simulated arms"
        return arm

    @pytest.fixture
    def velocity(self, robot: Robot) -> FloatArray:
        """(n,), away from home at different slow speeds, rad/s."""
        middle = (robot.limits.lower + robot.limits.upper) / 2
        return np.linspace(0.02, 0.05, robot.dof) * np.where(robot.home < middle, 1.0, -1.0)

    def test_being_made_does_not_move_it(self, arm: SimulatedArm, robot: Robot) -> None:
        arm.advance(DT_S)
        np.testing.assert_allclose(arm.state(), robot.home, atol=self.tolerance_rad)
        assert not arm.velocity().any()
        assert arm.simulated

    def test_it_moves_by_velocity_times_time(
        self, arm: SimulatedArm, robot: Robot, velocity: FloatArray
    ) -> None:
        for _ in range(50):
            arm.send(Command(velocity, duration_s=DT_S))
            arm.advance(DT_S)
        moved = arm.state() - robot.home
        np.testing.assert_allclose(moved, velocity * 50 * DT_S, atol=self.tolerance_rad)

    def test_it_reads_the_velocity_that_it_moves_at(self, arm: SimulatedArm, velocity: FloatArray) -> None:
        for _ in range(50):
            arm.send(Command(velocity, duration_s=DT_S))
            arm.advance(DT_S)
        np.testing.assert_allclose(arm.velocity(), velocity, atol=self.tolerance_rad / DT_S)

    def test_it_stops_by_itself_when_no_command_comes(
        self, arm: SimulatedArm, robot: Robot, velocity: FloatArray
    ) -> None:
        arm.send(Command(velocity, duration_s=0.05))
        for _ in range(10):
            arm.advance(DT_S)
        self._at_rest(arm, robot.home + velocity * 0.05)

    def test_a_command_runs_out_within_a_longer_step(
        self, arm: SimulatedArm, robot: Robot, velocity: FloatArray
    ) -> None:
        arm.send(Command(velocity, duration_s=0.05))
        arm.advance(1.0)
        self._at_rest(arm, robot.home + velocity * 0.05)

    def test_a_command_replaces_the_one_before(
        self, arm: SimulatedArm, robot: Robot, velocity: FloatArray
    ) -> None:
        arm.send(Command(velocity, duration_s=10.0))
        arm.send(Command(np.zeros(robot.dof), duration_s=DT_S))
        arm.advance(DT_S)
        self._at_rest(arm, robot.home)

    def test_stop_forgets_the_command(self, arm: SimulatedArm, robot: Robot, velocity: FloatArray) -> None:
        arm.send(Command(velocity, duration_s=1.0))
        arm.stop()
        arm.advance(DT_S)
        self._at_rest(arm, robot.home)

    def test_a_joint_stays_within_its_limits(self, arm: SimulatedArm, robot: Robot) -> None:
        velocity = np.zeros(robot.dof)
        velocity[0] = 2.0
        arm.send(Command(velocity, duration_s=100.0))
        for _ in range(200):
            arm.advance(0.5)
        assert arm.state()[0] <= robot.limits.upper[0] + self.tolerance_rad
        assert abs(arm.velocity()[0]) <= self.tolerance_rad / DT_S

    def test_nobody_can_reach_into_its_state(self, arm: SimulatedArm, robot: Robot) -> None:
        arm.state()[:] = 9.0
        arm.velocity()[:] = 9.0
        np.testing.assert_allclose(arm.state(), robot.home, atol=self.tolerance_rad)
        assert not arm.velocity().any()

    @pytest.mark.parametrize("wrong", ["short", "nan", "matrix"])
    def test_a_command_that_no_filter_would_send_is_an_error(
        self, arm: SimulatedArm, robot: Robot, wrong: str
    ) -> None:
        n = robot.dof
        velocity = {"short": np.zeros(n - 1), "nan": np.full(n, np.nan), "matrix": np.zeros((1, n))}[wrong]
        with pytest.raises(ValueError, match=f"{n} finite joint velocities"):
            arm.send(Command(velocity, duration_s=DT_S))

    @pytest.mark.parametrize("dt_s", [0.0, -1.0, np.nan, np.inf])
    def test_time_must_pass(self, arm: SimulatedArm, dt_s: float) -> None:
        with pytest.raises(UserError, match="time step"):
            arm.advance(dt_s)

    def _at_rest(self, arm: SimulatedArm, state: FloatArray) -> None:
        if self.settling_s:
            arm.advance(self.settling_s)
        np.testing.assert_allclose(arm.state(), state, atol=self.tolerance_rad)
        assert (np.abs(arm.velocity()) <= self.tolerance_rad / DT_S).all()
