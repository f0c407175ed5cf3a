"""Laws of arms that a person moves by hand."""

import numpy as np
import pytest

from latentarm.arms.real import GuidableArm, RealArm
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray, GripperCommand
from latentarm.robots.robot import Robot
from latentarm.testing.real_arm_rig import RealArmRig, StandIn


class GuidingLaws(RealArmRig):
    """Tests of a `GuidableArm`; they are skipped for any other arm."""

    push_rad = 0.05  # how far the joints are pushed by hand, rad

    def test_guided_by_hand_it_goes_where_it_is_pushed_and_takes_no_commands(
        self, new_arm: RealArm, stand_in: StandIn, velocity: FloatArray
    ) -> None:
        arm = self._guided(new_arm)
        before = stand_in.positions()
        self._drive(arm, velocity, 0.3)
        self._still(stand_in, before)
        push = self.push_rad * np.sign(velocity)
        stand_in.push(push)
        moved = stand_in.positions() - before
        assert (moved * np.sign(push) > 0.5 * self.push_rad).all(), moved
        self._wait_for(lambda: bool(np.abs(arm.read().q - before - moved).max() <= self.tolerance_rad))
        assert arm.status().phase == "guided"
        arm.disable()
        self._wait_for(lambda: arm.status().phase == "disabled")
        held = self._still(stand_in, stand_in.positions())
        stand_in.push(-push)
        self._still(stand_in, held)
        self._enable(arm)
        self._still(stand_in, held)

    @pytest.mark.parametrize("how", ["press_emergency_stop", "break_down", "cut"])
    def test_what_stops_an_arm_ends_guiding_for_good(
        self, new_arm: RealArm, stand_in: StandIn, how: str
    ) -> None:
        arm = self._guided(new_arm)
        getattr(stand_in, how)()
        try:
            self._wait_for(lambda: arm.status().phase != "guided")
            held = self._still(stand_in, stand_in.positions())
        finally:
            if how == "press_emergency_stop":
                stand_in.release_emergency_stop()
            elif how == "cut":
                stand_in.repair()
        if how == "cut":
            arm.close()
            arm.connect()
        self._wait_for(lambda: arm.status().phase != "emergency_stop")
        arm.recover()
        self._wait_for(lambda: arm.status().phase == "disabled")
        self._still(stand_in, held)

    def test_its_gripper_moves_while_it_is_guided(self, new_arm: RealArm, robot: Robot) -> None:
        if robot.gripper is None:
            pytest.skip("the robot has no gripper")
        arm = self._guided(new_arm)
        half_m = robot.gripper.width_m / 2.0
        arm.move_gripper(GripperCommand(half_m, 0.05, 5.0))
        self._wait_for(lambda: self._opens_by(arm, half_m), self.gripper_s)
        arm.disable()

    def _guided(self, arm: RealArm) -> GuidableArm:
        """The arm, connected and guided by hand."""
        if not isinstance(arm, GuidableArm):
            pytest.skip("this arm is not guided by hand")
        arm.connect()
        try:
            arm.guide()
        except UserError as error:
            pytest.skip(str(error))
        self._wait_for(lambda: arm.status().phase == "guided")
        return arm
