import numpy as np
import pytest

from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import SimulatedClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command, GripperCommand, GripperReading
from latentarm.robots.planar import planar


def test_a_joint_ends_at_its_hard_stop(the_panda):
    clock = SimulatedClock()
    arm = KinematicArm(the_panda, the_panda.home, clock.now_s)
    arm.connect()
    arm.enable()
    velocity = np.zeros(7)
    velocity[3] = 2.0
    arm.send(Command(velocity, duration_s=10.0))
    clock.wait_until(5.0)
    assert arm.read().q[3] == the_panda.limits.upper[3]
    assert arm.read().dq[3] == 0.0


def test_it_does_not_start_outside_its_limits(the_panda):
    start = the_panda.home.copy()
    start[3] = 0.5
    with pytest.raises(UserError, match=r"joint4 at 0\.5"):
        KinematicArm(the_panda, start, SimulatedClock().now_s)


@pytest.mark.parametrize("start", [np.zeros(6), np.full(7, np.nan), np.zeros((1, 7))])
def test_it_does_not_start_nowhere(the_panda, start):
    with pytest.raises(UserError, match="7 finite joint positions"):
        KinematicArm(the_panda, start, SimulatedClock().now_s)


def test_its_gripper_closes_at_its_speed_and_holds_nothing(the_panda):
    clock = SimulatedClock()
    arm = KinematicArm(the_panda, the_panda.home, clock.now_s)
    arm.connect()
    arm.enable()
    assert arm.spec.gripper == the_panda.gripper
    # The command's velocity runs out; its gripper does not. It is no faster than the gripper can be.
    arm.send(Command(np.zeros(7), duration_s=0.01, gripper=GripperCommand(0.01, 1.0, 20.0)))
    clock.wait_until(0.5)
    assert arm.read().gripper.width_m == pytest.approx(0.03)
    arm.stop()
    clock.wait_until(1.0)
    assert arm.read().gripper == GripperReading(pytest.approx(0.03), holding=False)
    with pytest.raises(ValueError, match="finite width"):
        arm.send(Command(np.zeros(7), 0.01, gripper=GripperCommand(np.nan, 1.0, 1.0)))
    bare = KinematicArm(planar(), planar().home, clock.now_s)
    assert bare.spec.gripper is None
    with pytest.raises(ValueError, match="no gripper"):
        bare.send(Command(np.zeros(5), 0.01, gripper=GripperCommand(0.0, 1.0, 1.0)))


def test_its_gripper_moves_without_the_arm_only_while_that_is_connected_and_disabled(the_panda):
    clock = SimulatedClock()
    arm = KinematicArm(the_panda, the_panda.home, clock.now_s)
    closing = GripperCommand(0.0, 0.1, 20.0)

    def width_after_asking():
        arm.move_gripper(closing)
        clock.wait_until(clock.now_s() + 0.2)
        arm.connect()
        return arm.read().gripper.width_m

    assert width_after_asking() == pytest.approx(0.08)  # it was off
    arm.enable()
    assert width_after_asking() == pytest.approx(0.08)
    arm.disable()
    assert width_after_asking() == pytest.approx(0.06)
    arm.close()
    assert width_after_asking() == pytest.approx(0.06)
