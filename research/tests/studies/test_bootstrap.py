import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import stats

from latentarm_research.studies.statistics import bootstrap_interval, reach_of_interval

probabilities = arrays(float, st.integers(1, 12), elements=st.floats(0, 1))


@given(probabilities)
@example(np.full(9, 0.875))
def test_the_interval_stays_within_the_values_and_around_their_mean(values):
    low, high = bootstrap_interval(values)
    assert values.min() <= low <= high <= values.max()
    below, above = reach_of_interval(values)
    assert min(below, above) >= 0
    assert values.mean() - below >= -1e-12


def test_of_many_normal_values_it_is_that_of_student():
    values = np.random.default_rng(0).normal(3.0, 1.0, 200)
    expected = stats.t.interval(0.95, 199, values.mean(), stats.sem(values))
    assert bootstrap_interval(values) == pytest.approx(expected, abs=0.03)


def test_it_is_the_same_every_time():
    values = np.random.default_rng(0).normal(size=(5, 3))
    np.testing.assert_array_equal(bootstrap_interval(values), bootstrap_interval(values))
