import numpy as np
import pytest
from scipy import stats

from latentarm_research.studies.shared_autonomy.tables import band, interval


def test_three_seeds_by_hand():
    values = np.array([[0.0, 2.0], [2.0, 2.0], [3.0, 3.0]])  # means 1, 2, 3
    found = interval(values)
    assert (found.mean, found.sd, found.n, found.over) == (2.0, 1.0, 3, "seeds")
    # t(0.975, 2) = 4.302653, over the root of 3
    assert found.half_width == pytest.approx(4.302653 / 3**0.5, rel=1e-6)
    assert (found.low, found.high) == (found.mean - found.half_width, found.mean + found.half_width)


def test_drives_with_one_model_are_a_cluster():
    """Many drives with the same three models say no more than the three models."""
    means = np.array([0.1, 0.2, 0.6])
    few, many = (interval(np.repeat(means[:, None], count, axis=1)) for count in (1, 100))
    assert few.n == many.n == 3
    assert many.half_width == pytest.approx(few.half_width)


def test_of_fewer_than_three_seeds_drives_are_the_units():
    values = np.random.default_rng(0).normal(size=(2, 10))
    found = interval(values)
    assert (found.n, found.over) == (20, "drives")
    low, high = stats.t.interval(0.95, 19, values.mean(), values.std(ddof=1) / 20**0.5)
    assert (found.low, found.high) == pytest.approx((low, high))


def test_figures_of_the_models_themselves_have_no_drives():
    found = interval(np.array([[1.0], [3.0]]))
    assert (found.mean, found.n, found.over) == (2.0, 2, "seeds")


def test_one_unit_has_no_interval():
    found = interval(np.array([[0.3]]))
    assert (found.mean, found.sd, found.half_width, found.n) == (0.3, 0.0, 0.0, 1)


def test_bands_of_probabilities_stay_within_zero_and_one():
    """Where most seeds are sure, mean ± t SE leaves [0, 1] and the bootstrap does not."""
    courses = np.array([[0.99, 0.01]] * 9 + [[0.2, 0.9]])
    mean, low, high = band(courses)
    t_half_width = interval(courses[:, :1]).half_width
    assert mean[0] + t_half_width > 1
    assert (low >= courses.min(axis=0)).all()
    assert (high <= courses.max(axis=0)).all()
    assert (low < mean).all()
    assert (mean < high).all()


def test_of_few_courses_there_is_no_band():
    courses = np.random.default_rng(1).normal(size=(2, 7))
    mean, low, high = band(courses)
    np.testing.assert_array_equal(low, mean)
    np.testing.assert_array_equal(high, mean)
