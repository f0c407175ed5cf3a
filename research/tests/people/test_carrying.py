"""What a simulated person expects of things that the tool holds."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from latentarm.core.types import Context, Pose
from latentarm.robots.catalogue import load_robot
from latentarm.robots.kinematics.pose_rows import pose_rows
from latentarm_research.people.motion import carried

JOINTS = st.lists(st.floats(-0.5, 0.5), min_size=7, max_size=7).map(np.array)


def relative(chain, state, row):
    """A thing's pose as the tool sees it: position and two columns of its rotation."""
    tool = chain.forward(state)
    return np.concatenate(
        [(row[:3] - tool.position) @ tool.rotation, (tool.rotation.T @ row[3:].reshape(3, 2)).ravel()]
    )


@given(JOINTS, JOINTS)
def test_what_is_held_keeps_its_place_in_the_tool_and_the_rest_stays(before, after):
    robot = load_robot("panda")
    rows = np.stack([pose_rows(Pose(np.array([0.5, 0.1, z]), np.eye(3))) for z in (0.2, 0.4)])
    here = Context(robot.home + before, np.zeros(0), objects=rows)
    there = carried(robot.chain, here, np.array([True, False]), robot.home + after)
    np.testing.assert_allclose(
        relative(robot.chain, there.state, there.objects[0]),
        relative(robot.chain, here.state, rows[0]),
        atol=1e-9,
    )
    np.testing.assert_array_equal(there.objects[1], rows[1])


def test_one_context_becomes_many():
    robot = load_robot("panda")
    rows = pose_rows(Pose(np.array([0.5, 0.1, 0.2]), np.eye(3)))[None]
    states = robot.home + np.linspace(0.0, 0.3, 6).reshape(2, 3, 1)
    many = carried(robot.chain, Context(robot.home, np.zeros(0), objects=rows), np.array([True]), states)
    assert many.objects.shape == (2, 3, 1, 9)
    np.testing.assert_allclose(many.objects[0, 0], rows, atol=1e-12)
