from dataclasses import replace

import mujoco
import numpy as np
import pytest

from latentarm.robots.kinematics.chain import Frame
from latentarm.robots.kinematics.reader import reference_positions
from latentarm.robots.kinematics.rotations import rotation_vector
from latentarm.robots.panda import panda
from latentarm.robots.robot import Robot

TOOLS = 2


def configurations(robot: Robot, count: int) -> np.ndarray:
    return np.random.default_rng(1).uniform(robot.limits.lower, robot.limits.upper, size=(count, robot.dof))


def tool_of_mujoco(robot: Robot, model, data, q, tool):
    data.qpos[:] = reference_positions(model)
    for name, position in zip(robot.joint_names, q, strict=True):
        data.joint(name).qpos[:] = position
    led = np.zeros((model.nv, robot.dof))
    led[[model.joint(name).dofadr[0] for name in robot.joint_names], range(robot.dof)] = 1.0
    for _ in range(model.neq):  # a leader may follow another joint
        for follower, leader, (shift, slope, *_) in zip(
            model.eq_obj1id, model.eq_obj2id, model.eq_data, strict=True
        ):
            to, by = model.jnt_qposadr[follower], model.jnt_qposadr[leader]
            data.qpos[to] = model.qpos0[to] + shift + slope * (data.qpos[by] - model.qpos0[by])
            led[model.jnt_dofadr[follower]] = slope * led[model.jnt_dofadr[leader]]
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    name = robot.chain.tools[tool].name
    linear, angular = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name) >= 0:
        placed = data.site(name)
        mujoco.mj_jacSite(model, data, linear, angular, model.site(name).id)
    else:
        placed = data.body(name)
        mujoco.mj_jacBody(model, data, linear, angular, model.body(name).id)
    jacobian = np.concatenate([linear, angular]) @ led
    return placed.xpos.copy(), placed.xmat.reshape(3, 3).copy(), jacobian


def test_chain_agrees_with_mujoco(robot):
    model = robot.model()
    data = mujoco.MjData(model)
    q = configurations(robot, 200)
    for tool in range(len(robot.chain.tools)):
        pose = robot.chain.forward(q, tool)
        jacobian = robot.chain.jacobian(q, tool)
        for i in range(len(q)):
            position, rotation, expected = tool_of_mujoco(robot, model, data, q[i], tool)
            np.testing.assert_allclose(pose.position[i], position, rtol=0, atol=1e-9)
            np.testing.assert_allclose(pose.rotation[i], rotation, rtol=0, atol=1e-9)
            np.testing.assert_allclose(jacobian[i], expected, rtol=0, atol=1e-9)


def test_points_on_links_agree_with_mujoco(robot):
    """Every body of the model, wherever it rides, is where MuJoCo has it."""
    from latentarm.robots.kinematics.reader import read

    model = robot.model()
    data = mujoco.MjData(model)
    reading = read(model, [tool.name for tool in robot.chain.tools])
    q = configurations(robot, 20)
    transforms = robot.chain.link_transforms(q)
    placed = robot.chain.points(transforms, reading.body_link, reading.body_transform[:, :3, 3])
    for i in range(len(q)):
        tool_of_mujoco(robot, model, data, q[i], 0)
        np.testing.assert_allclose(placed[i], data.xpos, rtol=0, atol=1e-9)


def test_jacobian_is_the_derivative_of_forward(robot):
    chain, step = robot.chain, 1e-6
    q = configurations(robot, 20)
    for tool in range(len(chain.tools)):
        jacobian = chain.jacobian(q, tool)
        for joint in range(chain.dof):
            ahead, behind = q.copy(), q.copy()
            ahead[:, joint] += step
            behind[:, joint] -= step
            to, back = chain.forward(ahead, tool), chain.forward(behind, tool)
            linear = (to.position - back.position) / (2 * step)
            angular = rotation_vector(to.rotation @ back.rotation.mT) / (2 * step)
            np.testing.assert_allclose(jacobian[:, :3, joint], linear, rtol=0, atol=1e-8)
            np.testing.assert_allclose(jacobian[:, 3:, joint], angular, rtol=0, atol=1e-8)


def test_panda_agrees_with_its_denavit_hartenberg_table():
    """The manufacturer's table (Craig's convention), multiplied out by hand."""
    a = [0, 0, 0, 0.0825, -0.0825, 0, 0.088, 0]
    d = [0.333, 0, 0.316, 0, 0.384, 0, 0, 0.107]
    alpha = np.deg2rad([0, -90, 90, 90, -90, 90, 90, 0])
    robot = panda()
    for q in configurations(robot, 100):
        flange = np.eye(4)
        for a_i, d_i, alpha_i, theta in zip(a, d, alpha, [*q, 0.0], strict=True):
            ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha_i), np.sin(alpha_i)
            flange = flange @ np.array(
                [
                    [ct, -st, 0, a_i],
                    [st * ca, ct * ca, -sa, -d_i * sa],
                    [st * sa, ct * sa, ca, d_i * ca],
                    [0, 0, 0, 1],
                ]
            )
        pose = robot.chain.forward(q)
        np.testing.assert_allclose(pose.position, flange[:3, 3] + 0.1034 * flange[:3, 2], rtol=0, atol=1e-9)
        np.testing.assert_allclose(pose.rotation[:, 2], flange[:3, 2], rtol=0, atol=1e-9)
        # The hand is turned by -45 degrees; its model writes the turn with six digits.
        turned = (flange[:3, 0] - flange[:3, 1]) / np.sqrt(2)
        np.testing.assert_allclose(pose.rotation[:, 0], turned, rtol=0, atol=5e-6)


def test_every_batch_shape_gives_what_single_configurations_give(robot):
    q = configurations(robot, 6).reshape(2, 3, robot.dof)
    chain = robot.chain
    pose, jacobian = chain.forward(q), chain.jacobian(q)
    start, _ = robot.capsules.placed(chain, chain.link_transforms(q))
    assert pose.position.shape == (2, 3, 3)
    assert jacobian.shape == (2, 3, 6, robot.dof)
    for i in np.ndindex(2, 3):
        single = chain.link_transforms(q[i])
        np.testing.assert_allclose(chain.forward(q[i]).rotation, pose.rotation[i], rtol=0, atol=1e-14)
        np.testing.assert_allclose(chain.jacobian(q[i]), jacobian[i], rtol=0, atol=1e-14)
        alone, _ = robot.capsules.placed(chain, single)
        np.testing.assert_allclose(alone, start[i], rtol=0, atol=1e-14)
    assert chain.forward(np.empty((0, robot.dof))).position.shape == (0, 3)


def test_forward_changes_nothing_it_was_given(robot):
    q = configurations(robot, 3)
    before = q.copy()
    first = robot.chain.forward(q).position.copy()
    robot.chain.jacobian(q)
    np.testing.assert_array_equal(q, before)
    np.testing.assert_array_equal(robot.chain.forward(q).position, first)


def test_moves_says_which_joint_moves_which_link(robot):
    chain = robot.chain
    q = configurations(robot, 1)[0]
    before = chain.link_transforms(q)
    for joint in range(chain.dof):
        shifted = q.copy()
        shifted[joint] += 0.3
        moved = np.abs(chain.link_transforms(shifted) - before).max(axis=(1, 2)) > 1e-9
        np.testing.assert_array_equal(moved, chain.moves @ (chain.ratio[:, joint] != 0.0))


def test_a_tool_on_the_base_stays(robot):
    chain = robot.chain
    fixed = np.eye(4)
    fixed[:3, 3] = [0.1, 0.2, 0.3]
    stand = replace(chain, tools=(Frame("stand", -1, fixed),))
    q = configurations(robot, 4)
    np.testing.assert_allclose(stand.forward(q).position, np.tile([0.1, 0.2, 0.3], (4, 1)))
    assert not stand.jacobian(q).any()


@pytest.mark.parametrize("arm", [0, 1])
def test_each_of_two_arms_moves_by_its_own_joints_alone(arm):
    from latentarm.robots.planar import planar

    robot = planar(arms=2)
    jacobian = robot.chain.jacobian(robot.home, tool=arm)
    own = slice(5 * arm, 5 * arm + 5)
    others = np.delete(jacobian, np.arange(10)[own], axis=1)
    assert not others.any()
    assert np.linalg.matrix_rank(jacobian[:, own]) == 3
