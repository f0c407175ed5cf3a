"""Contract tests of arms."""

import numpy as np
import pytest

from latentarm.arms.catalogue import ArmFactory
from latentarm.arms.contract import Arm, check_arm
from latentarm.control.clock import SimulatedClock
from latentarm.core.types import Command, FloatArray
from latentarm.robots.robot import Robot
from latentarm.testing.arm_laws import ArmLaws
from latentarm.testing.fault_trials import FAULTS, Fault, try_fault

DT_S = 0.02
ZERO_COMMAND_S = 0.15  # from a fault to a command of zero, s
REST_S = 0.4  # from a fault until the arm stands still, s


class ArmContract(ArmLaws):
    """Tests of an arm in simulated time.

    Override the fixture ``make``, and ``robot`` if the arm is not for a Panda::

        class TestTheirArm(ArmContract):
            @pytest.fixture
            def make(self):
                return TheirArm

    Attributes:
        tolerance_rad: allowed distance from where the commands lead, rad; larger for an arm with inertia.
        settling_s: how long it may take to come to rest, s.
        trials: how often each fault is tried.
    """

    tolerance_rad = 1e-9
    settling_s = 0.0
    trials = 1

    @pytest.fixture
    def make(self) -> ArmFactory:
        """What makes the arm."""
        raise NotImplementedError("override the fixture `make`")

    @pytest.fixture
    def clock(self) -> SimulatedClock:
        """The arm's clock."""
        return SimulatedClock()

    @pytest.fixture
    def new_arm(self, make: ArmFactory, robot: Robot, clock: SimulatedClock) -> Arm:
        return make(robot, robot.home, clock.now_s)

    @pytest.fixture
    def arm(self, new_arm: Arm) -> Arm:
        new_arm.connect()
        new_arm.enable()
        return new_arm

    @pytest.fixture
    def velocity(self, robot: Robot) -> FloatArray:
        """(n,), away from home at different slow speeds, rad/s."""
        middle = (robot.limits.lower + robot.limits.upper) / 2
        return np.linspace(0.02, 0.05, robot.dof) * np.where(robot.home < middle, 1.0, -1.0)

    def test_it_says_what_it_is(self, new_arm: Arm, robot: Robot) -> None:
        check_arm(new_arm.spec, robot)
        assert new_arm.spec.simulated, "these tests let time pass, so they are for simulated arms"
        assert new_arm.spec.rate_hz > 0.0

    def test_nothing_moves_it_before_it_is_enabled(
        self, new_arm: Arm, robot: Robot, clock: SimulatedClock, velocity: FloatArray
    ) -> None:
        new_arm.send(Command(velocity, duration_s=10.0))
        new_arm.connect()
        assert new_arm.status().phase == "disabled"
        new_arm.send(Command(velocity, duration_s=10.0))
        _wait(clock, 0.5)
        new_arm.enable()
        _wait(clock, 0.5)
        assert new_arm.status().phase == "ready"
        self._at_rest(new_arm, clock, robot.home)

    def test_it_moves_by_velocity_times_time(
        self, arm: Arm, robot: Robot, clock: SimulatedClock, velocity: FloatArray
    ) -> None:
        self._drive(arm, clock, velocity, ticks=50)
        assert arm.status().phase == "moving"
        reading = arm.read()
        np.testing.assert_allclose(reading.q - robot.home, velocity * 50 * DT_S, atol=self.tolerance_rad)
        np.testing.assert_allclose(reading.dq, velocity, atol=self.tolerance_rad / DT_S)

    def test_its_readings_say_when_they_were_taken(self, arm: Arm, clock: SimulatedClock) -> None:
        before = arm.read()
        for _ in range(5):
            _wait(clock, DT_S)
            reading = arm.read()
            assert clock.now_s() - DT_S < reading.time_s <= clock.now_s()
            assert reading.sequence > before.sequence
            before = reading

    @pytest.mark.parametrize("reads", [1, 10])
    def test_a_command_runs_out_even_if_nobody_asks(
        self, arm: Arm, robot: Robot, clock: SimulatedClock, velocity: FloatArray, reads: int
    ) -> None:
        arm.send(Command(velocity, duration_s=0.05))
        for _ in range(reads):
            _wait(clock, 1.0 / reads)
            arm.read()
        self._at_rest(arm, clock, robot.home + velocity * 0.05)

    def test_a_command_replaces_the_one_before(
        self, arm: Arm, robot: Robot, clock: SimulatedClock, velocity: FloatArray
    ) -> None:
        arm.send(Command(velocity, duration_s=10.0))
        arm.send(Command(np.zeros(robot.dof), duration_s=DT_S))
        _wait(clock, DT_S)
        self._at_rest(arm, clock, robot.home)

    def test_stop_forgets_the_command(
        self, arm: Arm, robot: Robot, clock: SimulatedClock, velocity: FloatArray
    ) -> None:
        arm.send(Command(velocity, duration_s=1.0))
        arm.stop()
        _wait(clock, DT_S)
        self._at_rest(arm, clock, robot.home)
        assert arm.status().phase == "ready"

    @pytest.mark.parametrize("how", ["disable", "close"])
    def test_disabling_and_closing_stop_it_for_good(
        self, arm: Arm, clock: SimulatedClock, velocity: FloatArray, how: str
    ) -> None:
        self._drive(arm, clock, velocity, ticks=10)
        getattr(arm, how)()
        getattr(arm, how)()
        _wait(clock, self.settling_s + DT_S)
        assert arm.status().phase == {"disable": "disabled", "close": "off"}[how]
        # What comes again after a lost connection never moves by itself, nor by what it is sent too early.
        arm.connect()
        assert arm.status().phase == "disabled"
        rested = arm.read().q
        arm.send(Command(velocity, duration_s=10.0))
        _wait(clock, 0.5)
        arm.connect()
        self._at_rest(arm, clock, rested)
        arm.enable()
        self._drive(arm, clock, velocity, ticks=10)
        assert (np.abs(arm.read().q - rested) > 5 * DT_S * np.abs(velocity)).all()

    def test_a_closed_arm_has_no_new_readings(self, arm: Arm, clock: SimulatedClock) -> None:
        before = arm.read()
        arm.close()
        _wait(clock, 1.0)
        assert arm.read().time_s <= before.time_s
        sequence = arm.read().sequence
        arm.connect()
        assert arm.read().sequence > sequence

    def test_a_joint_stays_within_its_limits(self, arm: Arm, robot: Robot, clock: SimulatedClock) -> None:
        velocity = np.zeros(robot.dof)
        velocity[0] = 2.0
        arm.send(Command(velocity, duration_s=100.0))
        _wait(clock, 5.0)
        assert arm.read().q[0] <= robot.limits.upper[0] + self.tolerance_rad
        assert abs(arm.read().dq[0]) <= self.tolerance_rad / DT_S

    def test_nobody_can_reach_into_its_state(self, arm: Arm, robot: Robot, clock: SimulatedClock) -> None:
        reading = arm.read()
        reading.q[:] = 9.0
        reading.dq[:] = 9.0
        _wait(clock, DT_S)
        self._at_rest(arm, clock, robot.home)

    @pytest.mark.parametrize("fault", list(FAULTS))
    def test_it_is_at_rest_soon_after_a_fault(self, make: ArmFactory, robot: Robot, fault: Fault) -> None:
        for seed in range(self.trials):
            self._stopped_in_time(make, robot, fault, seed)

    @pytest.mark.parametrize("late_ticks", [1, 2, 3, 4, 5])
    def test_it_is_driven_by_late_readings_and_stopped(
        self, make: ArmFactory, robot: Robot, late_ticks: int
    ) -> None:
        for seed in range(self.trials):
            self._stopped_in_time(make, robot, "stop_pressed", seed, 0.01 * late_ticks)

    def _stopped_in_time(
        self, make: ArmFactory, robot: Robot, fault: Fault, seed: int, late_s: float = 0.0
    ) -> None:
        trial = try_fault(make, robot, fault, seed, late_s)
        assert 0.0 < trial.zero_command_s <= ZERO_COMMAND_S
        assert 0.0 < trial.rest_s <= REST_S
        assert trial.moved_rad <= self.tolerance_rad
        assert trial.moves_again
        assert trial.reason

    def _drive(self, arm: Arm, clock: SimulatedClock, velocity: FloatArray, ticks: int) -> None:
        for _ in range(ticks):
            arm.send(Command(velocity, duration_s=2.5 * DT_S))
            _wait(clock, DT_S)
            arm.read()

    def _at_rest(self, arm: Arm, clock: SimulatedClock, state: FloatArray) -> None:
        if self.settling_s:
            _wait(clock, self.settling_s)
        np.testing.assert_allclose(arm.read().q, state, atol=self.tolerance_rad)
        assert (np.abs(arm.read().dq) <= self.tolerance_rad / DT_S).all()


def _wait(clock: SimulatedClock, span_s: float) -> None:
    clock.wait_until(clock.now_s() + span_s)
