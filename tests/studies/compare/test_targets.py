from latentarm.studies.compare.rows import condition
from latentarm.studies.compare.targets import TARGETS, verdicts
from latentarm.types import Row

GOOD = {
    "error_percent_of_pca": 42.0,
    "noise_free_error_percent_of_pca": 39.0,
    "drift": 0.0,
    "reversal": 0.05,
    "r2_local_axis_0": 0.97,
    "r2_local_axis_1": 0.99,
    "controllability_m": 0.01,
    "planned_reach_m": 0.0009,
}
CAE = {
    **GOOD,
    "error_percent_of_pca": 40.0,
    "noise_free_error_percent_of_pca": 39.0,
    "planned_reach_m": 0.0009,
}
WORSE = {
    "error_percent_of_pca": 42.1,
    "noise_free_error_percent_of_pca": 39.1,
    "drift": 0.001,
    "reversal": 0.051,
    "r2_local_axis_0": 0.969,
    "controllability_m": 0.0101,
    "planned_reach_m": 0.00091,
}


def judged(means: dict[str, float], other: dict[str, float] = CAE) -> list[bool]:
    rows = [
        Row("compare", measure, "1", mean, None, 5, "pour", model, condition(0.01))
        for model, of in (("isometric", means), ("cae", other))
        for measure, mean in of.items()
    ]
    return [one.met for one in verdicts(rows, "isometric", ["pour"], [0.01])]


def test_a_model_at_the_edge_of_every_target_meets_them() -> None:
    assert judged(GOOD) == [True] * len(TARGETS)


def test_a_little_worse_in_one_thing_misses_that_one_target() -> None:
    missed = [judged({**GOOD, measure: worse}).index(False) for measure, worse in WORSE.items()]
    assert missed == list(range(len(TARGETS)))
    for measure, worse in WORSE.items():
        assert judged({**GOOD, measure: worse}).count(False) == 1


def test_both_axes_count() -> None:
    assert not all(judged({**GOOD, "r2_local_axis_1": 0.9}))


def test_the_reference_is_shown_where_it_counts() -> None:
    rows = [
        Row("compare", measure, "1", mean, None, 5, "pour", model, condition(0.01))
        for model in ("isometric", "cae")
        for measure, mean in CAE.items()
    ]
    said = {one.target: one.said for one in verdicts(rows, "isometric", ["pour"], [0.01])}
    assert said["error ≤ 1.05 × cAE's"] == "40 % (cAE 40 %)"
    assert said["greedy reach ≤ 10 mm"] == "10 mm"


def test_nothing_is_judged_without_both_models() -> None:
    assert verdicts([], "isometric", ["pour"], [0.01]) == []
