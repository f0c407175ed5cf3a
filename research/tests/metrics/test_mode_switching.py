"""Time in mode switches: from the last push before one to the first push after it."""

import numpy as np
import pytest

from latentarm_research.metrics.stick import switching


def test_time_without_a_push_about_a_switch_counts_and_no_other():
    mode = np.array([0, 0, 0, 0, 1, 1, 1, 1, 1, 1])
    pushed = np.array([0, 1, 1, 0, 0, 0, 1, 0, 0, 1], dtype=bool)
    np.testing.assert_array_equal(np.flatnonzero(switching(mode, pushed)), [3, 4, 5])


def test_switches_on_the_way_to_a_mode_are_one_time():
    mode = np.array([0, 0, 1, 1, 2, 2, 2])
    pushed = np.array([1, 0, 0, 0, 0, 0, 1], dtype=bool)
    assert switching(mode, pushed).sum() == 5


@pytest.mark.parametrize(("pushed", "spent"), [([0, 0, 0, 0], 4), ([1, 1, 1, 1], 0), ([1, 0, 0, 0], 3)])
def test_a_switch_at_the_beginning_or_the_end(pushed, spent):
    assert switching(np.array([0, 0, 1, 1]), np.array(pushed, dtype=bool)).sum() == spent


def test_a_drive_in_one_mode_has_none():
    assert not switching(np.zeros(5), np.zeros(5, dtype=bool)).any()
