"""A fork in the hand: where its tool is, what it takes up, and what it can do."""

import mujoco
import numpy as np
import pytest

from latentarm.core.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.fork import with_fork
from latentarm.robots.kinematics.distances import segment_distance
from latentarm.robots.kinematics.reader import read
from latentarm.robots.planar import planar


def corners(model, geom):
    """(8, 3), of the box around a geom, in its body's frame."""
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    local = model.geom_aabb[geom][:3] + signs * model.geom_aabb[geom][3:]
    return local @ rotation.reshape(3, 3).T + model.geom_pos[geom]


def test_the_tool_lies_on_the_hands_axis_and_mujoco_agrees(the_panda):
    robot = load_robot("panda_fork")
    assert robot.gripper is None
    assert robot.still_joints == () == robot.driven_fingers
    model = robot.model()
    data = mujoco.MjData(model)
    assert model.nq == 7
    for q in np.random.default_rng(0).uniform(robot.limits.lower, robot.limits.upper, (5, 7)):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        hand, tool = the_panda.chain.forward(q), robot.chain.forward(q)
        np.testing.assert_allclose(tool.position, data.site("tool").xpos, atol=1e-9)
        np.testing.assert_allclose(tool.rotation, hand.rotation, atol=1e-5)
        reach = hand.rotation.T @ (tool.position - hand.position)
        np.testing.assert_allclose(reach[:2], 0.0, atol=1e-6)
        assert 0.04 < reach[2] < 0.15
    assert 0.02 < model.body_mass.sum() - the_panda.model().body_mass.sum() + 1e-9 < 0.3


def test_its_shell_covers_it_and_it_comes_close_to_a_plate():
    robot = load_robot("panda_fork")
    model = robot.model()
    reading = read(model, ["tool"])
    last = robot.capsules.link == 6
    for body in ("attachment", "tines"):
        to_link = reading.body_transform[model.body(body).id]
        for geom in np.flatnonzero(model.geom_bodyid == model.body(body).id):
            # The corners of a capsule's box lie outside of it.
            points = corners(model, geom) if model.geom_type[geom] != 3 else model.geom_pos[geom][None]
            points = points @ to_link[:3, :3].T + to_link[:3, 3]
            distance, _, _ = segment_distance(
                points[:, None], points[:, None], robot.capsules.start[last], robot.capsules.end[last]
            )
            assert (distance - robot.capsules.radius[last]).min(axis=1).max() < 1e-3
    ends = np.concatenate([robot.capsules.start[last], robot.capsules.end[last]])[:, 2]
    beyond = (ends + np.tile(robot.capsules.radius[last], 2)).max() - robot.chain.tools[0].transform[2, 3]
    assert 0.0 <= beyond < 0.01


def test_the_shell_covers_the_fingers_however_far_they_are_open(the_panda):
    model = the_panda.model()
    data = mujoco.MjData(model)
    data.qpos[:7] = the_panda.home
    start, end = the_panda.capsules.placed(the_panda.chain, the_panda.chain.link_transforms(the_panda.home))
    for opening in np.linspace(0.0, the_panda.gripper.width_m, 5):
        data.qpos[7:] = opening / 2.0
        mujoco.mj_kinematics(model, data)
        for side in ("left_finger", "right_finger"):
            body = model.body(side).id
            pads = [g for g in np.flatnonzero(model.geom_bodyid == body) if model.geom_type[g] == 6]
            for geom in pads:
                points = corners(model, geom) @ data.xmat[body].reshape(3, 3).T + data.xpos[body]
                distance, _, _ = segment_distance(points[:, None], points[:, None], start, end)
                assert (distance - the_panda.capsules.radius).min(axis=1).max() < 1e-9


def test_any_robot_can_hold_one_fork():
    robot = with_fork(planar(3))
    assert robot.chain.tools[0].name == "tool"
    assert robot.chain.forward(robot.home).position.shape == (3,)
    assert robot.tines is not None
    with pytest.raises(UserError, match="holds its fork already"):
        with_fork(robot)
