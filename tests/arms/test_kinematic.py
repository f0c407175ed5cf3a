import numpy as np
import pytest

from latentarm.arms.kinematic import KinematicArm
from latentarm.errors import UserError
from latentarm.types import Command

DT = 0.02


@pytest.fixture
def arm(the_panda):
    return KinematicArm(the_panda, the_panda.home, DT)


def test_it_moves_by_velocity_times_time(arm, the_panda):
    velocity = np.linspace(-0.1, 0.2, 7)
    for _ in range(10):
        arm.send(Command(velocity, duration_s=DT))
        arm.advance()
        np.testing.assert_array_equal(arm.velocity(), velocity)
    np.testing.assert_allclose(arm.state(), the_panda.home + velocity * 10 * DT, atol=1e-12)


def test_it_stops_by_itself_when_no_command_comes(arm, the_panda):
    arm.send(Command(np.full(7, 0.1), duration_s=0.05))
    for _ in range(10):
        arm.advance()
    np.testing.assert_allclose(arm.state(), the_panda.home + 0.1 * 0.05, atol=1e-12)
    assert not arm.velocity().any()


def test_a_command_runs_out_within_a_longer_step(arm, the_panda):
    arm.send(Command(np.full(7, 0.1), duration_s=0.05))
    arm.advance(1.0)
    np.testing.assert_allclose(arm.state(), the_panda.home + 0.1 * 0.05, atol=1e-12)
    assert not arm.velocity().any()


def test_stop_forgets_the_command(arm, the_panda):
    arm.send(Command(np.full(7, 0.1), duration_s=1.0))
    arm.stop()
    arm.advance()
    np.testing.assert_array_equal(arm.state(), the_panda.home)
    assert not arm.velocity().any()


def test_a_joint_ends_at_its_hard_stop(arm, the_panda):
    velocity = np.zeros(7)
    velocity[3] = 2.0
    arm.send(Command(velocity, duration_s=10.0))
    arm.advance(5.0)
    assert arm.state()[3] == the_panda.limits.upper[3]
    assert arm.velocity()[3] == 0.0


def test_nobody_can_reach_into_its_state(arm, the_panda):
    arm.state()[:] = 9.0
    arm.velocity()[:] = 9.0
    np.testing.assert_array_equal(arm.state(), the_panda.home)
    assert not arm.velocity().any()


@pytest.mark.parametrize("velocity", [np.zeros(6), np.full(7, np.nan), np.zeros((1, 7))])
def test_a_command_that_no_filter_would_send_is_an_error(arm, velocity):
    with pytest.raises(ValueError, match="7 finite joint velocities"):
        arm.send(Command(velocity, duration_s=DT))


def test_it_does_not_start_outside_its_limits(the_panda):
    start = the_panda.home.copy()
    start[3] = 0.5
    with pytest.raises(UserError, match=r"joint4 at 0\.5"):
        KinematicArm(the_panda, start, DT)


@pytest.mark.parametrize("start", [np.zeros(6), np.full(7, np.nan), np.zeros((1, 7))])
def test_it_does_not_start_nowhere(the_panda, start):
    with pytest.raises(UserError, match="7 finite joint positions"):
        KinematicArm(the_panda, start, DT)


@pytest.mark.parametrize("dt_s", [0.0, -1.0, np.nan, np.inf])
def test_time_must_pass(the_panda, dt_s):
    with pytest.raises(UserError, match="time step"):
        KinematicArm(the_panda, the_panda.home, dt_s)
