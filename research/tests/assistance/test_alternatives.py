import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.assistance.belief import alternatives, at_one_speed

vectors = st.integers(1, 6).flatmap(lambda d: hnp.arrays(float, d, elements=st.floats(-1, 1)))


@given(vectors)
def test_the_input_itself_comes_first(u):
    assert np.array_equal(alternatives(u)[0], u)


@given(st.integers(2, 6).flatmap(lambda d: hnp.arrays(float, d, elements=st.floats(-1, 1))))
def test_with_several_axes_all_take_the_same_effort(u):
    assert np.linalg.norm(alternatives(u), axis=-1) == pytest.approx(np.linalg.norm(u), abs=1e-12)


def test_two_axes_turn_through_eight_equal_angles():
    found = alternatives(np.array([0.5, 0.0]))
    angle = np.deg2rad(np.arange(0, 360, 45))
    assert found == pytest.approx(0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=-1))


def test_one_axis_could_have_been_pressed_to_six_levels():
    assert alternatives(np.array([0.3]))[:, 0].tolist() == [0.3, -1.0, -0.6, -0.2, 0.2, 0.6, 1.0]


def test_more_axes_could_have_been_pressed_one_by_one():
    found = alternatives(np.array([0.0, 0.3, 0.4]))
    assert found[1:] == pytest.approx(0.5 * np.concatenate([np.eye(3), -np.eye(3)]))


@pytest.mark.parametrize("axes", [1, 2, 3, 7])
def test_many_at_once_are_as_each_alone(axes, rng):
    u = rng.uniform(-1, 1, (3, 4, axes))
    assert np.array_equal(alternatives(u)[1, 2], alternatives(u[1, 2]))


def test_at_one_speed_only_the_direction_is_compared():
    actions = np.array([[0.3, 0.4], [2.0, 0.0], [0.0, -0.1], [0.0, 0.0]])
    assert at_one_speed(actions) == pytest.approx(np.array([[0.3, 0.4], [0.5, 0.0], [0.0, -0.5], [0.0, 0.0]]))
