import numpy as np
import pytest

from latentarm_research.metrics.undone import NEAR_M, undone_share


def line(*corners):
    """A path through corners, densely sampled."""
    corners = np.array(corners, dtype=float)
    share = np.linspace(0.0, len(corners) - 1, 500 * (len(corners) - 1) + 1)
    return np.stack([np.interp(share, range(len(corners)), axis) for axis in corners.T], axis=-1)


def test_a_straight_way_undoes_nothing():
    assert undone_share(line([0, 0, 0], [1, 0, 0])) == 0.0


def test_there_and_back_undoes_half():
    assert undone_share(line([0, 0, 0], [1, 0, 0], [0, 0, 0])) == pytest.approx(0.5, abs=0.01)


def test_a_part_of_the_way_back_undoes_that_part():
    """And as much before it as is near its end."""
    share = undone_share(line([0, 0, 0], [0.75, 0, 0], [0.5, 0, 0]))
    assert share == pytest.approx(0.25 + NEAR_M, abs=0.01)


def test_back_on_another_way_undoes_nothing():
    assert undone_share(line([0, 0, 0], [1, 0, 0], [1, 0.1, 0], [0, 0.1, 0])) == 0.0


def test_the_same_way_twice_undoes_nothing():
    angle = np.linspace(0.0, 4 * np.pi, 2000)
    assert undone_share(np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)) == 0.0


def test_an_arm_that_stands_still_undoes_nothing():
    assert undone_share(np.zeros((50, 3))) == 0.0
    assert undone_share(np.zeros((1, 3))) == 0.0
