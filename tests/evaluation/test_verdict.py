import pytest

from latentarm.core.types import Row
from latentarm.evaluation.measures import MEASURES, label_of, measure_of, unit_of
from latentarm.evaluation.verdict import THRESHOLDS, findings

GOOD = {
    "search_error_percent_of_pca": (40.0, 3.0),
    "drift": (0.0, 0.0),
    "reversal": (0.04, 0.01),
    "reversal_2_s": (0.05, 0.01),
    "motion_turn": (1.4, 0.1),
    "r2_local_axis_0": (0.99, 0.01),
    "r2_local_axis_1": (0.99, 0.01),
    "disentanglement_deg": (80.0, 5.0),
    "controllability_m": (0.006, 0.001),
    "start_distance_m": (0.19, 0.1),
}


def missed(**changed):
    figures = GOOD | changed
    return findings([Row("evaluate", name, "1", mean, sd, 5) for name, (mean, sd) in figures.items()])


def test_a_good_model_misses_nothing():
    assert missed() == []


@pytest.mark.parametrize(
    ("measure", "figure", "said"),
    [
        ("search_error_percent_of_pca", (130.0, 20.0), "no better than PCA"),
        ("search_error_percent_of_pca", (100.0, 0.0), "no better than PCA"),
        ("search_error_percent_of_pca", (90.0, 30.0), "not reliably better than PCA"),
        ("drift", (0.64, 0.1), "moves at rest (64 ± 10 %"),
        ("reversal", (0.57, 0.15), "does not go back"),
        ("reversal_2_s", (0.41, 0.1), "after 2 s the opposite push does not go back (41 ± 10 % is left"),
        ("motion_turn", (4.4, 0.2), "turns faster than the stick (4.4 ± 0.2 times"),
        ("r2_local_axis_1", (0.0, 0.0), "axis 2"),
        ("disentanglement_deg", (3.0, 1.0), "alike"),
        ("controllability_m", (0.12, 0.1), "does not reach goals (120 mm of 190 mm"),
    ],
)
def test_each_fault_is_said(measure, figure, said):
    (finding,) = missed(**{measure: figure})
    assert finding.measure == measure
    assert said in finding.said


def test_a_figure_that_is_absent_misses_nothing():
    assert missed(drift=(None, None)) == []


def test_every_measure_says_what_it_is_and_thresholds_are_on_its_worse_side():
    for name, measure in MEASURES.items():
        assert measure.definition, name
        assert not measure.definition.endswith("."), name
        assert (unit_of(name), label_of(name)) == (measure.unit, measure.label)
    for threshold in THRESHOLDS:
        measure = measure_of(threshold.measure)
        assert measure is not None
        assert measure.better == ("higher" if threshold.least else "lower")
