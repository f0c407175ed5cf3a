import numpy as np
import pytest

from latentarm.arms.kinematic import KinematicArm
from latentarm.control.clock import SimulatedClock
from latentarm.errors import UserError
from latentarm.types import Command


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
