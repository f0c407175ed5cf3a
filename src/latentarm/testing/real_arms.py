"""Contract tests of real arms, over wall-clock time, against a stand-in for the arm."""

import time
from collections.abc import Callable
from statistics import median

import numpy as np
import pytest

from latentarm.arms.contract import INPUT_BUDGET_S, check_arm
from latentarm.arms.real import RealArm
from latentarm.control.clock import MonotonicClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command, FloatArray, GripperCommand
from latentarm.robots.robot import Robot
from latentarm.testing.guiding_laws import GuidingLaws
from latentarm.testing.real_arm_rig import HOLD_S, Driving, StandIn

__all__ = ["RealArmContract", "StandIn"]
QUICK_S = 0.005  # a call that does not wait for the arm takes no longer than this, s


class RealArmContract(GuidingLaws):
    """Tests of the driver of a real arm; they take real time, so they are marked ``clock``.

    Override the fixtures ``stand_in`` and ``make``, and ``robot`` if the arm is not a Panda; ``refused`` and
    ``address`` where there is something for them::

        class TestTheirArm(RealArmContract):
            @pytest.fixture(scope="class")
            @classmethod
            def stand_in(cls):
                with their_server() as server:
                    yield server

            @pytest.fixture
            def make(self, stand_in, robot):
                where = parse_address(f"theirs://127.0.0.1:{stand_in.port}")
                return lambda: TheirArm(robot, where, MonotonicClock().now_s)

    Attributes:
        tolerance_rad: a joint that has moved no farther than this stands still, rad.
        settling_s: from the end of a command until the arm is at rest, beyond ``spec.stops_after_s``, s.
        waits_s: the longest that anything may take which the person waits for, such as enabling, s.
        arrives: least and most share of a commanded motion that is made; a slow simulation makes less of it.
        gripper_s: the gripper opens or closes by half within this time, s.
        push_rad: how far the joints of an arm that is guided are pushed, rad.
    """

    def test_it_says_what_it_is(self, new_arm: RealArm, robot: Robot) -> None:
        check_arm(new_arm.spec, robot)
        assert not new_arm.spec.simulated
        assert new_arm.spec.input_budget_s <= INPUT_BUDGET_S
        assert new_arm.spec.rate_hz > 0.0

    def test_looking_finds_something_and_changes_nothing(self, new_arm: RealArm, stand_in: StandIn) -> None:
        before = stand_in.positions()
        found = new_arm.look()
        assert not found.refusals
        assert found.facts
        assert all(fact.name and fact.value for fact in found.facts)
        assert new_arm.status().phase == "off"
        assert [fact.name for fact in new_arm.look().facts] == [fact.name for fact in found.facts]
        new_arm.connect()
        assert new_arm.status().phase == "disabled"
        self._still(stand_in, before)

    def test_watching_reads_and_leaves_the_arm_as_it_is(self, new_arm: RealArm, stand_in: StandIn) -> None:
        before = stand_in.positions()
        new_arm.watch()
        assert not new_arm.status().takes_commands
        first = new_arm.read().sequence
        self._wait_for(lambda: new_arm.read().sequence > first)
        np.testing.assert_allclose(new_arm.read().q, before, atol=self.tolerance_rad)
        new_arm.close()
        assert new_arm.status().phase == "off"
        self._still(stand_in, before)
        new_arm.connect()
        assert new_arm.status().phase == "disabled"

    def test_what_looking_refuses_connecting_refuses_with_the_same_sentence(
        self, refused: Callable[[], RealArm]
    ) -> None:
        arm = refused()
        try:
            said: tuple[str, ...] = arm.look().refusals
        except UserError as error:
            said = (str(error),)
        assert said
        assert all(sentence.endswith(".") for sentence in said)
        with pytest.raises(UserError) as error:
            arm.connect()
        assert str(error.value) in said
        assert arm.status().phase == "off"
        arm.close()

    def test_nothing_moves_it_before_it_is_enabled(
        self, new_arm: RealArm, robot: Robot, stand_in: StandIn, velocity: FloatArray
    ) -> None:
        before = stand_in.positions()
        new_arm.send(self._command(velocity, robot))
        new_arm.connect()
        assert new_arm.status().phase == "disabled"
        for _ in range(10):
            new_arm.send(self._command(velocity, robot))
            time.sleep(0.01)
        self._enable(new_arm)
        self._still(stand_in, before)
        assert new_arm.status().phase == "ready"

    def test_it_moves_as_it_is_told_and_reads_where_it_is(
        self, arm: RealArm, stand_in: StandIn, velocity: FloatArray
    ) -> None:
        before = stand_in.positions()
        began_s = time.monotonic()
        self._drive(arm, velocity, 0.5)
        assert arm.status().phase == "moving"
        told_s = time.monotonic() - began_s
        after = self._at_rest(arm, stand_in)
        share = (after - before) / (velocity * told_s)
        assert (share >= self.arrives[0]).all(), share
        assert (share <= self.arrives[1]).all(), share
        np.testing.assert_allclose(arm.read().q, after, atol=self.tolerance_rad)

    def test_its_readings_say_when_they_were_taken(self, arm: RealArm) -> None:
        clock, before = MonotonicClock(), arm.read()
        for _ in range(5):
            self._wait_for(lambda known=before: arm.read().sequence > known.sequence)
            reading = arm.read()
            assert before.time_s <= reading.time_s <= clock.now_s() + 1e-3
            assert clock.now_s() - reading.time_s < 0.1
            before = reading

    def test_a_command_runs_out(self, arm: RealArm, stand_in: StandIn, velocity: FloatArray) -> None:
        before = stand_in.positions()
        arm.send(Command(velocity, duration_s=HOLD_S))
        after = self._at_rest(arm, stand_in)
        lasts_s = HOLD_S + (arm.spec.stops_after_s or 0.0) + self.settling_s
        assert (np.abs(after - before) <= np.abs(velocity) * lasts_s + self.tolerance_rad).all()
        assert arm.status().phase == "ready"

    def test_stop_forgets_the_command(self, arm: RealArm, stand_in: StandIn, velocity: FloatArray) -> None:
        self._drive(arm, velocity, 0.2)
        arm.send(Command(velocity, duration_s=10.0))
        arm.stop()
        self._at_rest(arm, stand_in)
        assert arm.status().phase == "ready"

    @pytest.mark.parametrize("how", ["disable", "close"])
    def test_disabling_and_closing_stop_it_for_good(
        self, arm: RealArm, stand_in: StandIn, velocity: FloatArray, how: str
    ) -> None:
        self._drive(arm, velocity, 0.2)
        getattr(arm, how)()
        getattr(arm, how)()
        rested = self._at_rest(arm, stand_in)
        assert arm.status().phase == {"disable": "disabled", "close": "off"}[how]
        sequence = arm.read().sequence
        # What comes again after a lost connection never moves by itself, nor by what it is sent too early.
        arm.connect()
        assert arm.status().phase == "disabled"
        arm.send(Command(velocity, duration_s=10.0))
        self._enable(arm)
        self._still(stand_in, rested)
        assert arm.read().sequence > sequence
        self._drive(arm, velocity, 0.3)
        assert (np.abs(stand_in.positions() - rested) > self.tolerance_rad).all()

    def test_no_call_waits_for_the_arm(self, arm: RealArm, robot: Robot, velocity: FloatArray) -> None:
        calls: dict[str, Callable[[], object]] = {
            "read": arm.read,
            "status": arm.status,
            "send": lambda: arm.send(self._command(velocity, robot)),
            "stop": arm.stop,
            "disable": arm.disable,
            "recover": arm.recover,
            "enable": arm.enable,
        }
        for name, call in calls.items():
            took_s: list[float] = []
            for _ in range(9):
                began_s = time.perf_counter()
                call()
                took_s.append(time.perf_counter() - began_s)
                time.sleep(0.002)
            assert median(took_s) <= QUICK_S, name

    def test_nobody_can_reach_into_its_readings(self, arm: RealArm, stand_in: StandIn) -> None:
        reading = arm.read()
        if reading.q.flags.writeable:
            reading.q[:] = 9.0
        self._wait_for(lambda: arm.read().sequence > reading.sequence)
        np.testing.assert_allclose(arm.read().q, stand_in.positions(), atol=self.tolerance_rad)

    def test_an_emergency_stop_stops_it_until_somebody_enables_it_again(
        self, arm: RealArm, stand_in: StandIn, velocity: FloatArray
    ) -> None:
        self._drive(arm, velocity, 0.2)
        stand_in.press_emergency_stop()
        try:
            self._wait_for(lambda: arm.status().phase == "emergency_stop")
            assert arm.status().reason.endswith(".")
            self._drive(arm, velocity, 0.2)
            rested = self._at_rest(arm, stand_in)
        finally:
            stand_in.release_emergency_stop()
        self._wait_for(lambda: arm.status().phase != "emergency_stop")
        self._waits_to_be_enabled(arm, stand_in, velocity, rested)

    def test_after_a_fault_it_moves_only_when_it_was_enabled_again(
        self, arm: RealArm, stand_in: StandIn, velocity: FloatArray
    ) -> None:
        self._drive(arm, velocity, 0.2)
        stand_in.break_down()
        self._wait_for(lambda: arm.status().phase == "fault")
        assert arm.status().reason.endswith(".")
        assert arm.status().recoverable
        self._drive(arm, velocity, 0.2)
        self._waits_to_be_enabled(arm, stand_in, velocity, self._at_rest(arm, stand_in))

    def test_cut_off_it_rests_and_nothing_old_moves_it_afterwards(
        self, arm: RealArm, stand_in: StandIn, velocity: FloatArray
    ) -> None:
        self._drive(arm, velocity, 0.2)
        stand_in.cut()
        try:
            newest = arm.read().time_s
            self._drive(arm, velocity, 0.3)
            rested = self._at_rest(arm, stand_in)
            # The loop stops for either: readings that are old, or an arm that takes no commands.
            assert not arm.status().takes_commands or arm.read().time_s < newest + 0.2
            if not arm.status().takes_commands:
                assert arm.status().lost
        finally:
            stand_in.repair()
        self._still(stand_in, rested)
        arm.close()
        arm.connect()
        assert not arm.status().lost
        if arm.status().phase == "fault":
            arm.recover()  # some arms take the silence for a fault
        self._wait_for(lambda: arm.status().phase == "disabled")
        self._still(stand_in, rested)

    def test_it_rests_when_the_process_that_drives_it_is_killed(
        self, address: str, robot: Robot, stand_in: StandIn, velocity: FloatArray, make: Callable[[], RealArm]
    ) -> None:
        stops_after_s = make().spec.stops_after_s or 0.0
        before = stand_in.positions()
        with Driving(address, robot, velocity, HOLD_S) as driving:
            self._wait_for(lambda: driving.driving and (stand_in.positions() != before).any(), within_s=60.0)
            driving.kill()
            time.sleep(HOLD_S + stops_after_s + self.settling_s)
            self._still(stand_in, stand_in.positions())

    def test_its_gripper_goes_where_it_is_told(self, arm: RealArm, robot: Robot) -> None:
        if robot.gripper is None:
            pytest.skip("the robot has no gripper")
        half_m = robot.gripper.width_m / 2.0
        told = GripperCommand(half_m, 0.05, 5.0)
        arm.send(Command(np.zeros(robot.dof), HOLD_S, gripper=told))
        self._wait_for(lambda: self._opens_by(arm, half_m), self.gripper_s)

    def _waits_to_be_enabled(
        self, arm: RealArm, stand_in: StandIn, velocity: FloatArray, rested: FloatArray
    ) -> None:
        """After a stop by the arm itself: neither time, commands nor recovering move it; enabling lets it."""
        self._drive(arm, velocity, 0.2)
        if arm.status().phase == "fault":
            arm.recover()
        self._wait_for(lambda: arm.status().phase == "disabled")
        self._drive(arm, velocity, 0.2)
        self._still(stand_in, rested)
        self._enable(arm)
        self._still(stand_in, rested)
        self._drive(arm, velocity, 0.3)
        assert (np.abs(stand_in.positions() - rested) > self.tolerance_rad).any()
