"""Food is brought where it belongs, however it sits on the fork."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from latentarm.core.types import Pose
from latentarm.tasks.eating.stabbing import INTO_M, carried_over, over
from scene_states import at, standing

ASIDE = st.floats(-0.02, 0.02)
TURN = st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3)


def carrying(offset, turn, stabbed=("food",)):
    """A fork anywhere with food that sits on it at an offset."""
    rotation = Rotation.from_rotvec([np.pi, 0.0, 0.0]) * Rotation.from_rotvec(turn)
    tool = Pose(np.array([0.5, 0.0, 0.3]), rotation.as_matrix())
    food = Pose(tool.position + tool.rotation @ offset, tool.rotation)
    poses = {"food": food, "bowl": at(0.4, 0.2, 0.1)}
    return standing(tool=tool, poses=poses, stabbed=frozenset(stabbed))


@given(ASIDE, ASIDE, ASIDE, TURN, st.floats(0.0, 0.5))
def test_food_comes_to_the_same_place_wherever_it_sits_on_the_fork(x, y, z, turn, tilt_rad):
    state = carrying(np.array([x, y, z]), turn)
    pose = carried_over(state, "food", "bowl", 0.05, tilt_rad=tilt_rad)
    sits = (state.poses["food"].position - state.tool.position) @ state.tool.rotation
    usual = over(state, "bowl", 0.05, tilt_rad=tilt_rad)
    brought = pose.position + pose.rotation @ sits
    np.testing.assert_allclose(brought, usual.position + usual.rotation @ [0.0, 0.0, -INTO_M], atol=1e-12)
    np.testing.assert_array_equal(pose.rotation, usual.rotation)


def test_food_that_is_not_yet_held_changes_nothing():
    state = carrying(np.array([0.01, 0.0, 0.0]), [0.0, 0.0, 0.0], stabbed=())
    pose, usual = carried_over(state, "food", "bowl", 0.05), over(state, "bowl", 0.05)
    np.testing.assert_array_equal(pose.position, usual.position)
