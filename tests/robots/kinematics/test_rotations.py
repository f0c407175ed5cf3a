import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from latentarm.core.types import Pose
from latentarm.robots.kinematics.rotations import (
    angle_between,
    pose_error,
    rotation_vector,
)

directions = arrays(np.float64, 3, elements=st.floats(-1.0, 1.0)).filter(lambda v: np.linalg.norm(v) > 1e-3)
angles = st.one_of(
    st.floats(0.0, np.pi),
    st.floats(0.0, 1e-6),
    st.floats(np.pi - 1e-6, np.pi),
    st.sampled_from([0.0, 1e-300, 1e-12, np.pi / 2, np.pi]),
)


def turn(direction, angle):
    return angle * direction / np.linalg.norm(direction)


def rotation_from_vector(vector):
    """The exponential, by SciPy."""
    return Rotation.from_rotvec(vector.reshape(-1, 3)).as_matrix().reshape(*vector.shape, 3)


@given(directions, angles)
def test_the_logarithm_undoes_the_exponential(direction, angle):
    vector = turn(direction, angle)
    back = rotation_vector(rotation_from_vector(vector))
    # At pi both signs of the axis are the same turn.
    if np.pi - angle < 1e-7:
        np.testing.assert_allclose(np.abs(back @ vector), angle**2, rtol=0, atol=1e-12)
        np.testing.assert_allclose(
            rotation_from_vector(back), rotation_from_vector(vector), rtol=0, atol=1e-13
        )
    else:
        np.testing.assert_allclose(back, vector, rtol=0, atol=1e-13)


@given(st.integers(0, 2**32 - 1), st.sampled_from([(), (1,), (5,), (2, 3), (0,)]))
def test_the_exponential_undoes_the_logarithm_in_every_batch_shape(seed, shape):
    count = int(np.prod(shape))
    matrices = Rotation.random(max(count, 1), rng=np.random.default_rng(seed)).as_matrix()[:count]
    rotation = matrices.reshape(*shape, 3, 3)
    vector = rotation_vector(rotation)
    assert vector.shape == (*shape, 3)
    assert (np.linalg.norm(vector, axis=-1) <= np.pi + 1e-12).all()
    np.testing.assert_allclose(rotation_from_vector(vector), rotation, rtol=0, atol=1e-13)


@given(directions, angles, directions, angles)
def test_the_angle_between_rotations_is_the_turns_angle_and_symmetric(d1, first, d2, second):
    start = rotation_from_vector(turn(d1, first))
    turned = rotation_from_vector(turn(d2, second)) @ start
    np.testing.assert_allclose(angle_between(start, turned), second, rtol=0, atol=1e-7)
    np.testing.assert_allclose(angle_between(turned, start), angle_between(start, turned), rtol=0, atol=1e-7)
    assert angle_between(start, start) <= 1e-7


@given(directions, st.floats(0.0, 3.1), arrays(np.float64, 3, elements=st.floats(-2, 2)))
def test_following_the_pose_error_for_one_second_arrives(direction, angle, shift):
    start = Pose(np.array([0.1, 0.2, 0.3]), rotation_from_vector(np.array([0.3, -0.2, 0.9])))
    aim = Pose(start.position + shift, rotation_from_vector(turn(direction, angle)) @ start.rotation)
    error = pose_error(start, aim)
    np.testing.assert_allclose(start.position + error[:3], aim.position, rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        rotation_from_vector(error[3:]) @ start.rotation, aim.rotation, rtol=0, atol=1e-12
    )
