"""The arm in physics: it weighs something, its torques end, and it is the same each time."""

import numpy as np
import pytest

from latentarm.arms.mujoco import Imperfections, MujocoArm
from latentarm.control.clock import SimulatedClock
from latentarm.core.errors import UserError
from latentarm.core.types import Command
from latentarm.robots.model_file import load_model_file
from latentarm.robots.panda import TORQUE_LIMIT
from latentarm.robots.planar import planar

SLIDER = """<mujoco><worldbody><body name="stand"><geom size="0.1" mass="5"/>
<body name="arm"><joint name="turn" axis="0 0 1" range="-115 115" {turn}/>
<geom size="0.05" pos="0.2 0 0" mass="1"/>
<body name="side" pos="0.1 0 0"><joint name="finger" axis="0 1 0" range="-60 60"/>
<geom size="0.02" pos="0.1 0 0"/></body>
<body name="tip" pos="0.4 0 0"><joint name="lift" type="slide" axis="0 0 1" range="-0.3 0.3"/>
<geom size="0.03" mass="0.5"/><site name="tool"/></body></body></body></worldbody>
<actuator>{actuators}</actuator></mujoco>"""
MOTORS = """<motor joint="turn" gear="10" ctrlrange="-2 2" ctrllimited="true"/>
<position joint="lift" kp="100" forcerange="-30 30"/>"""


@pytest.fixture
def clock():
    return SimulatedClock()


def enabled(robot, clock, **imperfections):
    arm = MujocoArm(robot, robot.home, clock.now_s, Imperfections(**imperfections))
    arm.connect()
    arm.enable()
    return arm


def driven(arm, clock, velocity, ticks):
    """(ticks, n) positions and velocities after every tick of 10 ms."""
    readings = []
    for _ in range(ticks):
        arm.send(Command(velocity, duration_s=0.025))
        clock.wait_until(clock.now_s() + 0.01)
        readings.append(arm.read())
    return np.array([one.q for one in readings]), np.array([one.dq for one in readings])


@pytest.fixture
def slider(tmp_path):
    def load(actuators=MOTORS, turn=""):
        path = tmp_path / "slider.xml"
        path.write_text(SLIDER.format(actuators=actuators, turn=turn))
        return load_model_file(path, end_effector="tool")

    return load


def test_gravity_does_not_move_it_and_a_payload_makes_it_sag(the_panda, clock):
    alone, loaded = enabled(the_panda, clock), enabled(the_panda, clock, payload_kg=1.0)
    clock.wait_until(1.0)
    assert np.abs(alone.read().q - the_panda.home).max() < 1e-9
    fallen = (
        the_panda.chain.forward(loaded.read().q).position - the_panda.chain.forward(the_panda.home).position
    )
    assert -0.005 < fallen[2] < -1e-4


def test_it_reaches_the_velocity_and_keeps_it(the_panda, clock):
    velocity = np.array([0.1, 0.2, -0.3, 0.1, 0.5, -0.5, 0.5])
    _, dq = driven(enabled(the_panda, clock), clock, velocity, 60)
    assert np.abs(dq[10:] - velocity).max() < 0.02
    assert np.abs(dq[40:] - velocity).max() < 1e-3


@pytest.mark.parametrize("joint", range(7))
def test_a_velocity_changes_no_faster_than_the_joint_can(the_panda, clock, joint):
    arm = enabled(the_panda, clock)
    _, dq = driven(arm, clock, 0.5 * np.eye(7)[joint], 30)
    arm.stop()
    after = []
    for _ in range(30):
        clock.wait_until(clock.now_s() + 0.01)
        after.append(arm.read().dq)
    change = np.abs(np.diff(np.vstack([np.zeros(7), dq, after]), axis=0)) / 0.01
    # The servo overshoots what it is told by a little.
    assert (change <= 1.15 * the_panda.limits.acceleration).all()
    assert change[:, joint].max() > 0.9 * the_panda.limits.acceleration[joint]


def test_torques_end_at_the_limits_and_a_joint_that_is_held_does_not_leap(the_panda, clock):
    arm = enabled(the_panda, clock)
    model, data = arm.model, arm.data
    velocity = np.array([0.5, 0, 0, 0, 0, 0, 0])
    # Held as by a wall: its own speed is taken away after every millisecond.
    for _ in range(2000):
        arm.send(Command(velocity, duration_s=0.025))
        clock.wait_until(clock.now_s() + 0.001)
        arm.read()
        data.qpos[0], data.qvel[0] = the_panda.home[0], 0.0
        assert (np.abs(data.qfrc_actuator[:7]) <= np.array(TORQUE_LIMIT) + 1e-9).all()
    assert model.jnt_actfrcrange[0, 1] == 87.0
    assert abs(data.qfrc_actuator[0]) > 50.0
    arm.stop()
    _, dq = driven(arm, clock, np.zeros(7), 100)
    assert np.abs(dq[-1]).max() < 0.01
    moved = np.abs(arm.read().q[0] - the_panda.home[0])
    assert moved < 0.1  # a servo that had gone on counting would take the joint a whole radian further


def test_the_same_commands_give_the_same_bits(the_panda):
    def once(seed):
        clock = SimulatedClock()
        arm = enabled(the_panda, clock, position_noise_rad=1e-4, velocity_noise_rad_s=1e-3, seed=seed)
        return driven(arm, clock, np.full(7, 0.2), 50)

    (q, dq), (again_q, again_dq), (other_q, _) = once(0), once(0), once(1)
    np.testing.assert_array_equal(q, again_q)
    np.testing.assert_array_equal(dq, again_dq)
    assert (q != other_q).all()
    assert np.std(q - other_q) == pytest.approx(np.sqrt(2) * 1e-4, rel=0.2)


def test_a_delay_makes_readings_old_and_they_say_so(the_panda):
    clock, late = SimulatedClock(), SimulatedClock()
    q, _ = driven(enabled(the_panda, clock), clock, np.full(7, 0.2), 50)
    arm = enabled(the_panda, late, delay_s=0.03)
    delayed, _ = driven(arm, late, np.full(7, 0.2), 50)
    np.testing.assert_array_equal(delayed[3:], q[:-3])
    assert arm.read().time_s == pytest.approx(late.now_s() - 0.03)


def test_any_model_with_torque_limits_moves(slider, clock):
    robot = slider()
    assert robot.joint_names == ("turn", "lift")
    arm = enabled(robot, clock)
    q, dq = driven(arm, clock, np.array([0.3, -0.05]), 100)
    np.testing.assert_allclose(dq[-1], [0.3, -0.05], atol=1e-3)
    np.testing.assert_allclose(q[-1] - robot.home, [0.3, -0.05], atol=0.01)
    np.testing.assert_array_equal(arm.model.jnt_actfrcrange[[0, 2], 1], [20.0, 30.0])
    finger = arm.model.joint("finger").qposadr[0]
    assert abs(arm.data.qpos[finger]) < 1e-3


def test_a_limit_of_the_joint_counts_before_that_of_its_actuator(slider, clock):
    arm = enabled(slider(turn='actuatorfrcrange="-7 7"'), clock)
    assert arm.model.jnt_actfrcrange[0, 1] == 7.0


@pytest.mark.parametrize(
    "actuators",
    [
        "",
        '<position joint="lift" kp="100" forcerange="-30 30"/><motor joint="turn"/>',
        '<position joint="lift" forcerange="-30 30"/><position joint="turn" ctrlrange="-2 2"/>',
    ],
)
def test_a_model_without_a_torque_limit_is_refused(slider, clock, actuators):
    robot = slider(actuators)
    with pytest.raises(UserError, match=r"no torque limit for joint 'turn'.*forcerange"):
        MujocoArm(robot, robot.home, clock.now_s)


def test_so_is_one_of_ours(clock):
    with pytest.raises(UserError, match="planar states no torque limit"):
        MujocoArm(planar(), planar().home, clock.now_s)


@pytest.mark.parametrize("name", ["position_noise_rad", "velocity_noise_rad_s", "delay_s", "payload_kg"])
@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_imperfections_are_figures(name, value):
    with pytest.raises(UserError, match=name):
        Imperfections(**{name: value})
