import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from latentarm.assistance.controllers.end_effector import HOMEWARD_RAD_S, EndEffectorController
from latentarm.core.errors import UserError
from latentarm.core.types import Context
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.resolved_rates import Damping
from latentarm.robots.kinematics.rotations import pose_error

PANDA = load_robot("panda")
SPEED, TURN = 0.12, 0.4
CONTROLLER = EndEffectorController(PANDA, SPEED, TURN)
NO_BELIEF = np.zeros(0)

near_home = hnp.arrays(float, 7, elements=st.floats(-0.4, 0.4)).map(lambda moved: PANDA.home + moved)
inputs = hnp.arrays(float, 2, elements=st.floats(-1, 1))


def asked_twist(u, mode, rotation):
    """m/s along the base's axes and rad/s about the tool's, in the base frame."""
    match CONTROLLER.modes[mode]:
        case "x-y":
            return np.array([*(SPEED * u), 0, 0, 0, 0])
        case "z-yaw":
            return np.array([0, 0, SPEED * u[0], *(TURN * u[1] * rotation[:, 2])])
        case "roll-pitch":
            return np.array([0, 0, 0, *(TURN * (u[0] * rotation[:, 0] + u[1] * rotation[:, 1]))])


@pytest.mark.parametrize("mode", range(3))
@given(state=near_home, u=inputs)
def test_away_from_singularities_the_tool_moves_as_asked(mode, state, u):
    jacobian = PANDA.chain.jacobian(state)
    assume(np.linalg.svd(jacobian, compute_uv=False)[-1] > Damping().threshold)
    action = CONTROLLER.action(u, Context(state, NO_BELIEF), mode)
    asked = asked_twist(u, mode, PANDA.chain.forward(state).rotation)
    assert jacobian @ action == pytest.approx(asked, abs=1e-10)
    # And so it does when the arm really takes a short step.
    dt = 1e-5
    before, after = PANDA.chain.forward(state), PANDA.chain.forward(state + dt * action)
    assert pose_error(before, after) / dt == pytest.approx(asked, abs=1e-4)


@pytest.mark.parametrize("mode", range(3))
@given(state=near_home, u=inputs)
def test_motion_is_in_proportion_to_the_input(mode, state, u):
    context = Context(state, NO_BELIEF)
    whole, half = (CONTROLLER.action(share * u, context, mode) for share in (1.0, 0.5))
    assert half == pytest.approx(whole / 2, abs=1e-12)
    assert not CONTROLLER.action(np.zeros(2), context, mode).any()


STRETCHED = np.array([0.0, 0.0, 0.0, -0.07, 0.0, 0.0, 0.0])
WRIST_ALIGNED = np.array([0.0, -0.3, 0.0, -2.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("singular", [np.zeros(7), STRETCHED, WRIST_ALIGNED])
@pytest.mark.parametrize("mode", range(3))
def test_through_singular_configurations_joint_speeds_stay_bounded(singular, mode):
    rng = np.random.default_rng(0)
    damping = Damping()
    largest = np.hypot(SPEED, TURN) * np.sqrt(2) / min(damping.threshold, damping.factor)
    for distance in (0.0, 1e-12, 1e-6, 1e-3, 1e-2, 0.1):
        context = Context(singular + distance * rng.normal(size=7), NO_BELIEF)
        action = CONTROLLER.action(np.array([[1.0, 1.0], [1.0, -1.0]]), context, mode)
        assert np.isfinite(action).all()
        assert (np.linalg.norm(action, axis=-1) <= largest).all()


anywhere = hnp.arrays(float, 7, elements=st.floats(0.0, 1.0)).map(
    lambda share: PANDA.limits.lower + share * (PANDA.limits.upper - PANDA.limits.lower)
)


def along_axes(robot, controller, state, axis, mode):
    """Shares of a full input along the base's axes and about the tool's, for one axis of the input."""
    action = controller.action(np.eye(2)[axis], Context(state, NO_BELIEF), mode)
    twist = robot.chain.jacobian(state) @ action
    turn = robot.chain.forward(state).rotation.T @ twist[3:]
    return np.concatenate([twist[:3] / SPEED, turn / TURN])


@pytest.mark.parametrize("axis", range(2))
@pytest.mark.parametrize("mode", range(3))
@given(state=anywhere | st.sampled_from([np.zeros(7), STRETCHED, WRIST_ALIGNED]))
def test_everywhere_the_tool_hardly_moves_in_ways_that_were_not_asked_for(axis, mode, state):
    shares = along_axes(PANDA, CONTROLLER, state, axis, mode)
    row = ((0, 1), (2, 5), (3, 4))[mode][axis]
    assert -1e-9 <= shares[row] <= 1 + 1e-9
    others = np.delete(np.abs(shares), row)
    assert (others <= np.delete(np.repeat([1 / 20, 1 / 6], 3), row) + 1e-9).all()


def test_a_held_cup_that_is_tilted_over_a_bowl_does_not_dive_into_it():
    # Joints 5 and 7 are nearly aligned here: a tilt took the tool 8 cm down within a second.
    state = np.array([-0.583, -0.384, 0.458, -2.265, -2.102, 3.123, 2.53])
    begin = PANDA.chain.forward(state)
    for _ in range(100):
        state = state + 0.01 * CONTROLLER.action(np.array([0.0, -1.0]), Context(state, NO_BELIEF), 2)
    end = PANDA.chain.forward(state)
    assert np.linalg.norm(end.position - begin.position) < 0.003
    assert np.arccos((np.trace(end.rotation.T @ begin.rotation) - 1) / 2) > 0.25


@given(state=anywhere, z=inputs)
def test_the_way_home_never_moves_the_tool(state, z):
    there = Context(state, NO_BELIEF)
    both = CONTROLLER.action(z, there, 0) + CONTROLLER.action(-z, there, 0)  # what is linear cancels
    assert PANDA.chain.jacobian(state) @ both == pytest.approx(np.zeros(6), abs=1e-9)
    assert np.linalg.norm(both) <= 2 * np.abs(z).max() * HOMEWARD_RAD_S + 1e-9


def test_an_elbow_that_was_turned_aside_comes_home_while_the_tool_goes_to_and_fro():
    state = PANDA.home.copy()
    for _ in range(600):
        spare = np.linalg.svd(PANDA.chain.jacobian(state))[2][-1]
        state = state + 0.002 * spare * np.sign(spare[2])
    aside = np.linalg.norm(state - PANDA.home)
    for tick in range(400):
        there = Context(state, NO_BELIEF)
        state = state + 0.01 * CONTROLLER.action(np.array([(-1.0) ** (tick // 50), 0.0]), there, 0)
    assert aside > 0.5
    assert np.linalg.norm(state - PANDA.home) < 0.5 * aside


def test_a_joint_that_does_not_move_the_tool_stays_where_it_is(tmp_path):
    inner = '<site name="tool" pos=".1 0 0"/>'
    for number, axis in enumerate(("1 0 0", "0 1 0", "0 0 1", "0 1 0", "1 0 0", "0 1 0", "0 0 1")):
        joint = f'<joint name="j{number}" axis="{axis}" range="-2 2"/>'
        inner = f'<body pos=".1 0 .1">{joint}<geom size=".02"/>{inner}</body>'
    lamp = '<body pos="2 0 0"><joint name="lamp" axis="0 1 0" range="-2 2"/><geom size=".02"/></body>'
    path = tmp_path / "arm_and_lamp.xml"
    path.write_text(f"<mujoco><worldbody>{inner}{lamp}</worldbody></mujoco>")
    robot = load_robot(str(path), end_effector="tool")
    state = robot.home + np.linspace(0.2, 0.5, robot.dof)
    action = EndEffectorController(robot, SPEED, TURN).action(np.ones(2), Context(state, NO_BELIEF), 0)
    assert (action != 0.0).tolist() == [name != "lamp" for name in robot.joint_names]


FIVE_JOINTS = """
<mujoco><worldbody><body>
  <joint name="pan" axis="0 0 1" range="-1.9 1.9"/><geom size=".03"/>
  <body pos=".03 0 .1"><joint name="lift" axis="0 1 0" range="-1.7 1.7"/><geom size=".02"/>
    <body pos=".03 0 .11"><joint name="elbow" axis="0 1 0" range="-1.7 1.7"/><geom size=".02"/>
      <body pos=".13 0 0"><joint name="flex" axis="0 1 0" range="-1.7 1.7"/><geom size=".02"/>
        <body pos=".06 0 0"><joint name="roll" axis="1 0 0" range="-2.7 2.7"/><geom size=".02"/>
          <site name="tool" pos=".1 0 0" euler="0 90 0"/>
</body></body></body></body></body></worldbody></mujoco>
"""


def test_an_arm_of_five_joints_moves_its_tool_straight_and_turns_it_only_in_place(tmp_path):
    path = tmp_path / "five.xml"
    path.write_text(FIVE_JOINTS)
    robot = load_robot(str(path), end_effector="tool")
    controller, state = EndEffectorController(robot, SPEED, TURN), np.array([0.2, -0.2, 0.4, 0.9, 0.1])
    for mode, axis, row in ((0, 0, 0), (0, 1, 1), (1, 0, 2)):
        shares = along_axes(robot, controller, state, axis, mode)
        assert shares[:3] == pytest.approx(np.eye(6)[row, :3], abs=0.05)
    for mode, axis in ((1, 1), (2, 0), (2, 1)):
        assert np.abs(along_axes(robot, controller, state, axis, mode)[:3]).max() < 1 / 20


@given(st.floats(0.0, 3.0), st.floats(0.0, 1e-6))
def test_the_damped_reciprocal_has_no_jump_and_no_peak(singular, further):
    damping = Damping()
    here, there = damping.inverse(np.array([singular, singular + further]))
    assert 0.0 <= here <= 1 / damping.threshold + 1e-9
    assert abs(there - here) <= 1e-3


def test_a_planar_arm_moves_in_its_plane_exactly_though_it_has_no_other_axis():
    planar = load_robot("planar")
    state = planar.home + np.linspace(0.1, 0.5, planar.dof)
    action = EndEffectorController(planar, 0.1, 0.5).action(
        np.array([0.6, -0.8]), Context(state, NO_BELIEF), 0
    )
    assert planar.chain.jacobian(state)[:2] @ action == pytest.approx([0.06, -0.08], abs=1e-9)


@pytest.mark.parametrize("wrong", [{"linear_speed": 0.0}, {"angular_speed": float("nan")}])
def test_speeds_that_are_none_are_refused(wrong):
    with pytest.raises(UserError, match=next(iter(wrong))):
        EndEffectorController(PANDA, **wrong)


def test_damping_that_is_none_is_refused():
    with pytest.raises(UserError, match="factor"):
        Damping(factor=-1.0)
