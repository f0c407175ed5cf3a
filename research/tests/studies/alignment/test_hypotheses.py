"""What is made of errors: tests, verdicts and targets. Warnings are errors, so every case is one without."""

import json
from dataclasses import asdict

import numpy as np
import pytest
from scipy import stats

from latentarm_research.studies.alignment.curves import PRIORS_AT_RANDOM
from latentarm_research.studies.alignment.hypotheses import (
    HYPOTHESES,
    answers_needed,
    compare_conditions,
    targets,
)
from latentarm_research.studies.alignment.preset import (
    ALL_PRIORS,
    CHOSEN,
    IDEAL,
    NO_ALIGN,
    SINGLE_PRIORS,
    WITHOUT_PRIORS,
)
from latentarm_research.studies.alignment.scene import AlignmentCell
from latentarm_research.studies.alignment.turning import FEW, TurningResult
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


def test_each_decoder_is_a_family_of_its_own(result):
    """With another decoder beside it that shows nothing, the p-values stay as they are."""
    alone = compare_conditions([result()])
    beside = compare_conditions([result(), result((1.0,) * 10, model="isometric", spread=0.1)])
    assert [one.p_holm for one in beside if one.family == "cae"] == [one.p_holm for one in alone]
    # Where all are alike, nothing is below another, and everything near to Ideal Align.
    assert all(
        (one.says == "held") == ("times" in one.claim.against[0])
        for one in beside
        if one.family == "isometric"
    )


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


def by_name(found):
    return {target.name.split(",")[0]: target for target in found}


def test_targets_are_met_where_they_are(result, curve):
    found = targets([result(), result(task="pour")], [curve(faster=4.0), curve("pour", faster=4.0)], [])
    assert all(target.met for target in found if "lowest SD" not in target.name)
    assert found[0].figures == "1.00 to 1.00 times; 2 of 2"
    assert json.loads(json.dumps([asdict(target) for target in found]))


def test_a_target_that_is_missed_says_where_and_by_how_much(result):
    means = (3.0, 2.0, 1.0, 0.7, 0.35, 0.4, 0.36, 0.15, 0.1, 0.1)
    found = by_name(targets([result(), result(means, noise=0.5), result(means, task="pour")], [], []))
    lowest = found["All Priors has the lowest mean of the paper's conditions with few answers"]
    assert not lowest.met
    assert lowest.figures == (
        "1 of 3; not Plane, noise 0.5: 0.36, Reversible 0.35; Pour, noise 0: 0.36, Reversible 0.35"
    )
    single = found["each single prior has at most 0.6 of the error of No Priors"]
    assert not single.met
    assert single.figures.startswith("0.35 to 0.70; 7 of 9; not Plane, noise 0.5: Proportional 0.70")
    near = found["Tool Space has at most 1.25 times the error of Ideal Align"]
    assert not near.met
    assert near.figures == "1.00 to 1.50 times; 1 of 3; not Plane, noise 0.5 1.50; Pour, noise 0 1.50"


@pytest.mark.parametrize(("faster", "needed"), [(1.0, 10), (2.0, 6), (10.0, 1), (0.9, None)])
def test_the_answers_that_are_needed_are_the_fewest_measured(curve, faster, needed):
    assert answers_needed(curve(faster=faster, counts=(1, 3, 6, 10))) == needed


def test_every_task_must_need_few_answers(curve):
    good, bad = curve("plane", faster=4.0), curve("pour", faster=0.5, counts=(1, 3, 6, 10))
    missed = targets([], [good, bad], [])[0]
    assert not missed.met
    assert missed.figures == "Plane with 3; Pour with no measured number"
    assert targets([], [good, curve("reach_and_pour", faster=4.0)], [])[0].met


def test_curves_that_hold_too_little_are_not_judged(curve):
    assert targets([], [curve(counts=(1, 3))], []) == []
    assert PRIORS_AT_RANDOM in curve().errors


def test_people_whose_axes_turn_are_compared_with_the_ideal_of_the_same_people(curve):
    errors = {
        PRIORS_AT_RANDOM: np.array([0.3, 0.3, 0.3]),
        CHOSEN: np.array([0.1, 0.1, 0.9]),
        FEW: np.array([0.2, 0.2, 0.6]),
        IDEAL: np.array([0.09, 0.09]),
    }
    near, few = targets([], [], [TurningResult(AlignmentCell("turning", curve().cell.learned, 0.0), errors)])
    assert near.met
    assert near.figures == "0.1 against 0.09, 1.11 times, the same 2 people"
    assert not few.met
    assert few.figures == "0.333 against 0.3"


def test_figures_that_are_all_the_same_have_no_spread(result):
    tests = compare_conditions([result(spread=0.0)])
    assert {test.why_not for test in tests} == {"no spread on either side"}
    assert np.isfinite([test.mean for test in tests]).all()
