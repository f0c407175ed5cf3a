from latentarm.core.types import Row
from latentarm_research.studies.compare.hypotheses import FIT_S, TARGETS, verdicts
from latentarm_research.studies.compare.tables import condition

GOOD = {
    "search_error_percent_of_pca": 20.0,
    "search_noise_free_error_percent_of_pca": 19.0,
    "drift": 0.0,
    "reversal": 0.05,
    "r2_local_axis_0": 0.97,
    "r2_local_axis_1": 0.99,
    "motion_turn": 1.5,
    "controllability_m": 0.008,
    "planned_reach_m": 0.0002,
    FIT_S: 10.0,
}
CAE = {**GOOD, "search_error_percent_of_pca": 23.0, "search_noise_free_error_percent_of_pca": 22.0}
HOMOGENEOUS = {**GOOD, "motion_turn": 4.2, FIT_S: 20.0}
WORSE = {
    "search_error_percent_of_pca": (20.1, {"error ≤ homogeneous's"}),
    "search_noise_free_error_percent_of_pca": (19.1, {"noise-free error ≤ homogeneous's"}),
    "drift": (0.001, {"drift 0"}),
    "reversal": (0.051, {"reversal ≤ 5 %"}),
    "r2_local_axis_0": (0.969, {"local R² ≥ 0.97 on both axes"}),
    "r2_local_axis_1": (0.9, {"local R² ≥ 0.97 on both axes"}),
    "motion_turn": (1.51, {"joints' turn per stick's ≤ 1.5"}),
    "controllability_m": (0.0081, {"greedy reach ≤ cAE's"}),
    "planned_reach_m": (0.00021, {"planned reach ≤ 0.2 mm"}),
    FIT_S: (10.1, {"training time ≤ 0.5 × homogeneous's"}),
}


def judged(ours: str = "isometric", **of: dict[str, float]) -> dict[str, tuple[bool, str]]:
    rows = [
        Row("compare", measure, "1", mean, None, 5, "pour", model, condition(0.01))
        for model, means in of.items()
        for measure, mean in means.items()
        if measure != FIT_S
    ]
    times = {("pour", 0.01, model): means[FIT_S] for model, means in of.items()}
    return {one.name: (one.met, one.figures) for one in verdicts(rows, ours, ["pour"], [0.01], times)}


def test_a_model_at_the_edge_of_every_target_meets_them() -> None:
    verdict = judged(isometric=GOOD, cae=CAE, homogeneous=HOMOGENEOUS)
    assert len(verdict) == len(TARGETS)
    assert all(met for met, _ in verdict.values())


def test_a_little_worse_in_one_thing_misses_that_one_target() -> None:
    for measure, (worse, expected) in WORSE.items():
        verdict = judged(isometric={**GOOD, measure: worse}, cae=CAE, homogeneous=HOMOGENEOUS)
        assert {target for target, (met, _) in verdict.items() if not met} == expected


def test_the_other_model_is_shown_where_it_counts() -> None:
    verdict = judged(isometric=GOOD, cae=CAE, homogeneous=HOMOGENEOUS)
    assert verdict["error ≤ cAE's"][1] == "20 % (cAE 23 %)"
    assert verdict["training time ≤ 0.5 × homogeneous's"][1] == "10 s (homogeneous 20 s)"
    assert verdict["planned reach ≤ 0.2 mm"][1] == "0.2 mm"


def test_no_model_is_judged_by_itself_or_by_one_that_was_not_compared() -> None:
    assert not any("homogeneous" in target for target in judged("homogeneous", homogeneous=HOMOGENEOUS))
    assert not any("cAE" in target for target in judged("homogeneous", homogeneous=HOMOGENEOUS))
    assert any("cAE" in target for target in judged("homogeneous", homogeneous=HOMOGENEOUS, cae=CAE))
    assert judged("scl", homogeneous=HOMOGENEOUS, cae=CAE) == {}
