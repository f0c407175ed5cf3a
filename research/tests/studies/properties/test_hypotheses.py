"""The whole suite turns warnings into errors, so every case here is one without warnings too."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from latentarm.models.estimators import MODELS
from latentarm_research.studies.claim_tables import verdicts_by_task
from latentarm_research.studies.properties.cell import PropertiesCell, PropertiesResult
from latentarm_research.studies.properties.hypotheses import (
    FURTHER_MODELS,
    HYPOTHESES,
    LINEAR,
    MARK,
    PAPERS_MODELS,
    compare_models,
    conditioned,
)
from latentarm_research.studies.properties.preset import PRESETS

ERROR = "median_error_percent_of_pca"


def result(model, measure, values, task="sine"):
    cell = PropertiesCell(task, model, PRESETS["smoke"], 0)
    return PropertiesResult(cell, {measure: np.array(values, dtype=float)}, decoder=None)


def only(results):
    (comparison,) = compare_models(results)
    return comparison


def test_the_models_that_see_the_context_are_told_from_those_that_do_not():
    assert {name for name in MODELS if not conditioned(name)} == {"pca", "ae", "vae"}


def test_two_models_are_compared_by_welch():
    cae, ae = [1.0, 2.0, 2.5, 1.5], [5.0, 9.0, 6.0]
    one = only([result("cae", ERROR, cae), result("ae", ERROR, ae)])
    expected = stats.ttest_ind(cae, ae, equal_var=False, alternative="less")
    assert (one.hypothesis, one.claim.subject, one.claim.against) == ("H1", ("cae",), ("ae",))
    assert one.method == "Welch's t"
    assert (one.n, one.n_against) == (4, 3)
    assert one.test.t == pytest.approx(expected.statistic)
    assert one.test.dof == pytest.approx(expected.df)
    assert one.p == one.p_holm == pytest.approx(expected.pvalue)
    assert one.test.g < 0
    assert one.says == "held"


@pytest.mark.parametrize("pca", [[100.0], [100.0, 100.0, 100.0], [100.0, 100.0, 100.0 + 1e-11]])
def test_a_model_without_spread_is_a_fixed_figure(pca):
    cae = [40.0, 50.0, 45.0]
    one = only([result("cae", ERROR, cae), result("pca", ERROR, pca)])
    expected = stats.ttest_1samp(cae, 100.0, alternative="less")
    assert one.method == "one-sample t"
    assert one.p == pytest.approx(expected.pvalue)
    assert one.test.t == pytest.approx(expected.statistic)
    assert one.says == "held"


def test_the_conditioned_model_may_be_the_fixed_figure():
    ae = [40.0, 50.0, 45.0]
    better = only([result("scl", ERROR, [3.0, 3.0]), result("ae", ERROR, ae)])
    worse = only([result("scl", ERROR, [99.0, 99.0]), result("ae", ERROR, ae)])
    assert better.p == pytest.approx(stats.ttest_1samp(ae, 3.0, alternative="greater").pvalue)
    assert better.says == "held"
    assert better.test.t < 0
    assert better.test.g < 0
    assert worse.p > 0.5
    assert worse.test.g > 0
    assert worse.test.t > 0


def test_what_is_worse_is_not_held_to_be_better():
    one = only([result("cae", ERROR, [90.0, 91.0, 92.0]), result("ae", ERROR, [50.0, 51.0, 52.0])])
    assert one.p > 0.99
    assert one.says == "not held"
    assert one.test.g > 0


def test_r2_is_compared_with_the_threshold():
    high = only([result("cvae", "r2", [0.97, 0.98, 0.99, 0.98]), result("ae", "r2", [0.1, 0.2, 0.3, 0.1])])
    low = only([result("cvae", "r2", [0.85, 0.95, 0.89, 0.92])])
    assert (high.claim.against, high.mean_against, high.n_against) == (MARK, LINEAR, 1)
    assert high.says == "held"
    assert low.says == "not held"


def test_r2_on_other_tasks_is_no_part_of_the_hypotheses():
    assert compare_models([result("cae", "r2", [0.9, 0.8], task="circle")]) == []


def test_two_seeds_are_enough_for_a_test_but_not_for_every_effect_size():
    welch = only([result("cae", ERROR, [1.0, 1.1]), result("ae", ERROR, [90.0, 91.0])])
    fixed = only([result("cae", ERROR, [1.0, 1.1]), result("pca", ERROR, [100.0])])
    assert welch.says == fixed.says == "held"
    assert welch.test.g < 0
    assert fixed.test.g is None


@pytest.mark.parametrize(
    ("cae", "ae"),
    [
        ([1.0], [2.0]),
        ([1.0, 1.0], [2.0, 2.0]),
        ([0.0, 0.0], [0.0, 0.0]),
        ([1.0, np.nan], [2.0, 3.0]),
        ([np.nan, np.nan], [2.0, 3.0]),
        ([1.0, 1.5], [np.nan, np.nan]),
        ([], [2.0, 3.0]),
    ],
)
def test_what_cannot_be_tested_supports_nothing_and_says_why(cae, ae):
    one = only([result("cae", ERROR, cae), result("ae", ERROR, ae)])
    assert one.p is one.p_holm is one.test is None
    assert one.why_not
    (verdict,) = verdicts_by_task(HYPOTHESES, [one])
    assert one.says == verdict.says == "could not be tested"
    assert f"cAE < AE ({one.why_not})" in verdict.why


def test_a_reference_is_not_excused_by_seeds_that_failed():
    one = only([result("cae", ERROR, [1.0, 1.1, 0.9]), result("ae", ERROR, [90.0, np.nan, 91.0])])
    assert one.n_against == 2
    assert one.says == "held"


def study(rng, seeds=10, reach_mean=30.0):
    means = {"pca": 100.0, "ae": 60.0, "vae": 70.0, "cae": 3.0, "cvae": 4.0, "scl": 5.0}
    results = []
    for task in ("sine", "reach"):
        for model, mean in means.items():
            mean = reach_mean if (task, model) == ("reach", "cvae") else mean
            values = [mean] if model == "pca" else rng.normal(mean, 1.0, seeds)
            results.append(result(model, ERROR, values, task))
    return results


def test_p_is_corrected_over_the_papers_models_and_over_the_others_apart():
    comparisons = compare_models(study(np.random.default_rng(0)))
    paper = [one for one in comparisons if one.family == PAPERS_MODELS]
    further = [one for one in comparisons if one.family == FURTHER_MODELS]
    assert len(paper) == 2 * 2 * 3
    assert {one.claim.subject for one in further} == {("scl",)}
    for family in (paper, further):
        ordered = sorted(family, key=lambda one: one.p)
        by_hand = np.maximum.accumulate([one.p * (len(family) - k) for k, one in enumerate(ordered)])
        assert [one.p_holm for one in ordered] == pytest.approx(np.minimum(by_hand, 1.0))


def test_verdicts_name_the_task_and_what_failed_there():
    rng = np.random.default_rng(0)
    good = verdicts_by_task(HYPOTHESES, compare_models(study(rng)))
    assert [(one.family, one.task) for one in good] == [
        (family, task) for family in (PAPERS_MODELS, FURTHER_MODELS) for task in ("sine", "reach")
    ]
    assert {one.says for one in good} == {"held"}
    bad = verdicts_by_task(HYPOTHESES, compare_models(study(rng, reach_mean=65.0)))
    assert [one.says for one in bad] == ["held", "not held", "held", "held"]
    assert bad[1].why.endswith(": cVAE < AE")
    assert ";" not in bad[1].why


def test_comparisons_are_plain_figures():
    first = compare_models(study(np.random.default_rng(0), seeds=2))[0]
    assert json.loads(json.dumps(first.as_json(), allow_nan=False))["says"] == first.says
    assert replace(first, p_holm=None).says == "could not be tested"
