"""What is made of errors: tests, verdicts and targets. Warnings are errors, so every case is one without."""

import json

import numpy as np
import pytest
from scipy import stats

from latentarm_research.studies.alignment.hypotheses import (
    HYPOTHESES,
    compare_conditions,
)
from latentarm_research.studies.alignment.preset import (
    ALL_PRIORS,
    IDEAL,
    NO_ALIGN,
    SINGLE_PRIORS,
    WITHOUT_PRIORS,
)
from latentarm_research.studies.claim_tables import verdicts_by_task

AS_IN_THE_PAPER = (3.0, 2.0, 1.0, 0.4, 0.35, 0.4, 0.11, 0.1, 0.1, 0.1)
"""Means of the conditions, in their order."""


def only(tests, hypothesis, condition, against):
    (one,) = [
        test
        for test in tests
        if (test.hypothesis, test.claim.subject, test.claim.against) == (hypothesis, (condition,), (against,))
    ]
    return one


def test_what_the_paper_concludes_is_supported_where_it_is_so(result):
    results = [result(noise=noise, task=task) for task in ("plane", "pour") for noise in (0.0, 0.1)]
    tests = compare_conditions(results)
    assert len(tests) == sum(len(one.claims) for one in HYPOTHESES) * len(results)
    assert all(test.says == "held" for test in tests)
    found = verdicts_by_task(HYPOTHESES, tests)
    assert [(verdict.hypothesis.name, verdict.task) for verdict in found] == [
        (name, task) for name in ("H1", "H2", "H3") for task in ("plane", "pour")
    ]
    assert {verdict.says for verdict in found} == {"held"}
    assert json.loads(json.dumps(tests[0].as_json()))["says"] == "held"


def test_the_statistic_is_welchs(result):
    one = only(compare_conditions([result()]), "H2", ALL_PRIORS, WITHOUT_PRIORS)
    measured = result()
    expected = stats.ttest_ind(
        measured.errors[ALL_PRIORS], measured.errors[WITHOUT_PRIORS], equal_var=False, alternative="less"
    )
    assert (one.method, one.n, one.n_against) == ("Welch's t", 6, 6)
    assert one.test.t == pytest.approx(expected.statistic)
    assert one.p == pytest.approx(expected.pvalue)
    assert one.test.g < 0


def test_no_align_is_a_fixed_figure(result):
    one = only(compare_conditions([result()]), "H1", IDEAL, NO_ALIGN)
    assert one.method == "one-sample t"
    expected = stats.ttest_1samp(result().errors[IDEAL], 3.0, alternative="less")
    assert one.p == pytest.approx(expected.pvalue)


def test_near_to_ideal_is_tested_against_a_quarter_more(result):
    one = only(compare_conditions([result()]), "H2", ALL_PRIORS, f"1.25 times {IDEAL}")
    assert one.mean == pytest.approx(0.11)
    assert one.mean_against == pytest.approx(1.25 * 0.1)
    assert one.says == "held"
    far = only(
        compare_conditions([result((*AS_IN_THE_PAPER[:-1], 0.05))]), "H2", ALL_PRIORS, f"1.25 times {IDEAL}"
    )
    assert far.says == "not held"
    assert far.test.g > 0


def test_one_run_cannot_be_tested_and_does_not_hold(result):
    tests = compare_conditions([result(runs=1)])
    assert {test.p for test in tests} == {None}
    assert {one.says for one in verdicts_by_task(HYPOTHESES, tests)} == {"could not be tested"}


def test_what_fails_is_named_with_its_noise(result):
    means = (*AS_IN_THE_PAPER[:6], 0.5, 0.1, 0.1, 0.1)  # All Priors is worse than each alone
    tests = compare_conditions([result(means, noise=noise) for noise in (0.0, 0.5)])
    third = verdicts_by_task(HYPOTHESES, tests)[2]
    assert third.why.startswith("6 of 6 claims do not hold: ")
    assert all(f"{name} (noise {noise})" in third.why for name in SINGLE_PRIORS for noise in ("0", "0.5"))


def test_figures_that_are_all_the_same_have_no_spread(result):
    tests = compare_conditions([result(spread=0.0)])
    assert {test.why_not for test in tests} == {"no spread on either side"}
    assert np.isfinite([test.mean for test in tests]).all()
