import numpy as np
import pytest

from latentarm_research.metrics.preference_alignment import alignment_by_step, preference_alignment


def test_pointing_as_needed_is_one_and_the_other_way_minus_one():
    down, out = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    points = np.stack([down, down, out, -down])
    assert preference_alignment(points, np.stack([down] * 4)) == pytest.approx((1 + 1 + 0 - 1) / 4)
    assert np.isnan(preference_alignment(np.zeros((0, 3)), np.zeros((0, 3))))


def test_alignment_by_step_is_the_mean_while_each_was_under_way():
    down, out = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    points = np.stack([down, down, out, -down])
    needed = np.stack([down, out, out, down])
    steps = ("stab", "scoop", "dip", "set down")
    by_step = alignment_by_step(steps, np.array([0, 0, 1, 2]), points, needed)
    assert [(one.step, one.alignment, one.ticks) for one in by_step] == [
        ("stab", 0.5, 2),
        ("scoop", 1.0, 1),
        ("dip", -1.0, 1),
    ]
    whole = preference_alignment(points, needed)
    assert np.average([one.alignment for one in by_step], weights=[one.ticks for one in by_step]) == whole
    assert alignment_by_step(steps, np.zeros(0, int), np.zeros((0, 3)), np.zeros((0, 3))) == ()
