import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import minimize

from latentarm.robots.kinematics.chain import Capsules
from latentarm.robots.kinematics.distances import segment_distance
from latentarm.robots.planar import planar

points = arrays(np.float64, 3, elements=st.floats(-2.0, 2.0).map(lambda x: round(x, 3)))


def by_scipy(p1, q1, p2, q2):
    """Least distance, found by minimising the convex function of both parameters from several starts."""

    def squared(parameters):
        s, t = parameters
        gap = p1 + s * (q1 - p1) - p2 - t * (q2 - p2)
        return gap @ gap

    found = [
        minimize(squared, start, bounds=[(0, 1), (0, 1)], options={"ftol": 1e-16, "gtol": 1e-12}).fun
        for start in ((0.5, 0.5), (0.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    ]
    return np.sqrt(max(min(found), 0.0))


def on_segment(point, start, end):
    length = np.linalg.norm(end - start)
    return abs(np.linalg.norm(point - start) + np.linalg.norm(end - point) - length) < 1e-6


@given(points, points, points, points)
def test_distance_is_the_least_there_is(p1, q1, p2, q2):
    distance, first, second = segment_distance(p1, q1, p2, q2)
    assert on_segment(first, p1, q1)
    assert on_segment(second, p2, q2)
    np.testing.assert_allclose(np.linalg.norm(first - second), distance, rtol=0, atol=1e-12)
    np.testing.assert_allclose(distance, by_scipy(p1, q1, p2, q2), rtol=0, atol=2e-4)
    grid = np.linspace(0.0, 1.0, 41)
    on_first = p1 + grid[:, None] * (q1 - p1)
    on_second = p2 + grid[:, None] * (q2 - p2)
    brute = np.linalg.norm(on_first[:, None] - on_second[None], axis=-1).min()
    assert distance <= brute + 1e-12


@given(points, points, points, st.floats(-2, 2), st.floats(0, 1e-6))
def test_parallel_and_nearly_parallel_segments(p1, direction, shift, along, tilt):
    """Between parallel lines the closest points are many; the distance is one."""
    q1 = p1 + direction
    p2 = p1 + shift + along * direction
    q2 = p2 + direction + tilt
    distance, _, _ = segment_distance(p1, q1, p2, q2)
    ends = [
        segment_distance(p1, p1, p2, q2)[0],
        segment_distance(q1, q1, p2, q2)[0],
        segment_distance(p1, q1, p2, p2)[0],
        segment_distance(p1, q1, q2, q2)[0],
    ]
    # Where segments cross at a tilt near the rounding of doubles, up to 10 nm are lost.
    assert distance <= min(ends) + 1e-7
    # For parallel segments some end is always among the closest points.
    if tilt == 0.0:
        np.testing.assert_allclose(distance, min(ends), rtol=0, atol=1e-7)


@given(points, points, points, points)
def test_distance_is_symmetric(p1, q1, p2, q2):
    forth, first, second = segment_distance(p1, q1, p2, q2)
    back, _, _ = segment_distance(p2, q2, p1, q1)
    turned, _, _ = segment_distance(q1, p1, q2, p2)
    np.testing.assert_allclose([back, turned], forth, rtol=0, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(first - second), forth, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("segments", "expected"),
    [
        (([0, 0, 0], [0, 0, 0], [1, 2, 2], [1, 2, 2]), 3.0),  # two points
        (([0, 0, 0], [0, 0, 0], [-1, 1, 0], [1, 1, 0]), 1.0),  # a point beside a segment
        (([-1, 1, 0], [1, 1, 0], [3, 1, 0], [3, 1, 0]), 2.0),  # a point beyond a segment
        (([-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0]), 0.0),  # crossing
        (([-1, 0, 0], [1, 0, 0], [0, -1, 0.5], [0, 1, 0.5]), 0.5),  # crossing at a height
        (([0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]), 1.0),  # on one line
        (([0, 0, 0], [1, 0, 0], [0.5, 0, 0], [3, 0, 0]), 0.0),  # on one line, overlapping
        (([0, 0, 0], [1, 0, 0], [0, 2, 0], [1, 2, 0]), 2.0),  # parallel
        (([0, 0, 0], [1, 0, 0], [0, 0, 0], [1, 0, 0]), 0.0),  # the same
        (([0, 0, 0], [5e-4, 0, 0], [3e-4, 1e-3, 0], [3e-4, 1e-3, 0]), 1e-3),  # half a millimetre long
    ],
)
def test_known_distances(segments, expected):
    distance, _, _ = segment_distance(*(np.array(end, dtype=float) for end in segments))
    assert distance == pytest.approx(expected, abs=1e-12)


def test_batches_broadcast():
    rng = np.random.default_rng(0)
    many, one = rng.normal(size=(2, 3, 7, 3)), rng.normal(size=3)
    distance, first, second = segment_distance(many, many + 1.0, one, one * 2)
    assert distance.shape == (2, 3, 7)
    assert first.shape == second.shape == (2, 3, 7, 3)
    alone, _, _ = segment_distance(many[1, 2, 3], many[1, 2, 3] + 1.0, one, one * 2)
    assert distance[1, 2, 3] == pytest.approx(alone)


def test_capsules_ride_on_their_links_and_on_the_base():
    robot = planar(n_links=2)
    capsules = Capsules(
        name=("base", "second link"),
        link=np.array([-1, 1]),
        start=np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]),
        end=np.array([[0.0, 0.0, 0.2], [0.5, 0.0, 0.0]]),
        radius=np.array([0.1, 0.1]),
    )
    start, end = capsules.placed(robot.chain, robot.chain.link_transforms(np.array([np.pi / 2, -np.pi / 2])))
    np.testing.assert_allclose(start, [[0, 0, 0.1], [0, 0.5, 0]], atol=1e-12)
    np.testing.assert_allclose(end, [[0, 0, 0.2], [0.5, 0.5, 0]], atol=1e-12)
