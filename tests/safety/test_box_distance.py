import numpy as np
import pytest

from latentarm.robots.kinematics.distances import box_separation


def height(normal, start, end, centre, rotation, extents):
    """Of the lower end of the segment above the box's supporting plane."""
    reach = normal @ centre + np.abs(normal @ rotation) @ extents
    return min(normal @ start, normal @ end) - reach


def random_pairs(count, seed, spread):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        rotation *= np.sign(np.linalg.det(rotation))
        start, end = rng.normal(size=(2, 3)) * spread
        if rng.uniform() < 0.2:
            end = start.copy()
        if rng.uniform() < 0.2:
            end = start + rotation[:, rng.integers(3)] * rng.normal()
        yield start, end, rng.normal(size=3) * 0.1, rotation, rng.uniform(0.02, 0.5, 3)


@pytest.mark.parametrize("spread", [0.3, 1.0])
def test_the_plane_stands_at_the_distance(oracle, spread):
    from latentarm.robots.kinematics.obstacles import Box

    module = __import__(oracle.__module__, fromlist=["box_distance"])
    for start, end, centre, rotation, extents in random_pairs(300, 1, spread):
        normal = box_separation(start[None], end[None], centre[None], rotation[None], extents[None])[0]
        assert abs(normal @ normal - 1.0) < 1e-9
        box = Box("box", centre, rotation, extents)
        distance = float(module.box_distance(start[None], end[None], box)[0])
        found = height(normal, start, end, centre, rotation, extents)
        if distance > 1e-6:
            assert found == pytest.approx(distance, abs=1e-6)
        else:
            assert found <= 1e-6


def test_inside_the_way_out_is_through_the_nearest_face():
    eye = np.eye(3)[None]
    start = np.array([[0.0, 0.0, 0.15]])
    end = np.array([[0.05, 0.0, 0.18]])
    normal = box_separation(start, end, np.zeros((1, 3)), eye, np.full((1, 3), 0.2))
    np.testing.assert_allclose(normal[0], [0, 0, 1])
