import json

import numpy as np
import pytest
from scipy import stats

from latentarm_research.studies.claim_tables import verdicts_by_task
from latentarm_research.studies.shared_autonomy.cell import METHODS, AutonomyCell, AutonomyResult, Outcome
from latentarm_research.studies.shared_autonomy.hypotheses import (
    HYPOTHESES,
    REACHED,
    TRAPPED,
    compare_methods,
)
from latentarm_research.studies.shared_autonomy.preset import Preset

PRESET = Preset("tiny", betas=(0.0, 75.0, 1e4), learners={"slow": 10.0}, changes_s=(0.0, 8.0))
TASK = "panda_two_cups"


def results_of(errors, task=TASK, model="cae"):
    """Cells whose drives have the errors of (method, person), one per seed; 0.5 for all others."""

    def outcome(method, person, seeds=4):
        values = np.asarray(errors.get((method, person.label), 0.5 + 0.01 * np.arange(seeds)))
        course = np.zeros((len(values), 3))
        return Outcome(method, person, {"final_state_error": values[:, None]}, course, course)

    return [
        AutonomyResult(
            cell,
            tuple(outcome(method, person) for method in cell.methods for person in PRESET.people),
        )
        for cell in (AutonomyCell(task, model, entropy, PRESET, 0) for entropy in (False, True))
    ]


def one(comparisons, hypothesis, method, against):
    (found,) = [
        test
        for test in comparisons
        if (test.hypothesis, test.claim.subject, test.claim.against) == (hypothesis, (method,), (against,))
    ]
    return found


ALONE, HELPED, OPENED = [1.0, 1.3, 1.2, 1.4], [0.2, 0.25, 0.24, 0.3], [0.1, 0.12, 0.15, 0.11]


def test_methods_are_compared_seed_by_seed():
    errors = dict(zip([(method, "beta 75") for method in METHODS], (ALONE, HELPED, OPENED), strict=True))
    tests = compare_methods(results_of(errors), PRESET)
    h1 = [test for test in tests if test.hypothesis == "H1"]
    assert [(*test.claim.subject, *test.claim.against) for test in h1] == [
        ("LA+SA", "LA"),
        ("LA+SA+Entropy", "LA"),
    ]
    raw = [stats.ttest_rel(values, ALONE, alternative="less") for values in (HELPED, OPENED)]
    for test, expected in zip(h1, raw, strict=True):
        assert test.method == "paired t"
        assert test.test.t == pytest.approx(expected.statistic)
        assert test.p == pytest.approx(expected.pvalue)
        assert test.test.g < 0
        assert test.apart
        assert test.says == "held"
    # Holm: the smaller p counts twice, the other once, and none less than one before it.
    small, large = sorted(test.p for test in h1)
    assert sorted(test.p_holm for test in h1) == pytest.approx([2 * small, max(2 * small, large)])


def test_significant_but_overlapping_is_not_enough_for_h1():
    near = [value - 0.05 - 0.001 * index for index, value in enumerate(ALONE)]
    errors = {("LA", "beta 75"): ALONE, ("LA+SA", "beta 75"): near, ("LA+SA+Entropy", "beta 75"): near}
    test = one(compare_methods(results_of(errors), PRESET), "H1", "LA+SA", "LA")
    assert test.p_holm < 0.01
    assert test.apart is False
    assert test.says == "not held"


def test_marks_of_the_change_of_mind():
    late = "change after 8 s"
    errors = {("LA+SA", late): [0.95, 0.9, 1.0, 0.97], ("LA+SA+Entropy", late): OPENED}
    tests = compare_methods(results_of(errors), PRESET)
    assert one(tests, "H2", "LA+SA+Entropy", "LA+SA").says == "held"
    reached, trapped = (
        one(tests, "H2", "LA+SA+Entropy", f"{REACHED:g}"),
        one(tests, "H2", "LA+SA", f"{TRAPPED:g}"),
    )
    assert reached.mean_against == REACHED
    assert trapped.mean_against == TRAPPED
    expected = stats.ttest_1samp(OPENED, REACHED, alternative="less")
    assert (reached.test.t, reached.p) == pytest.approx((expected.statistic, expected.pvalue))
    expected = stats.ttest_1samp(errors["LA+SA", late], TRAPPED, alternative="greater")
    assert (trapped.test.t, trapped.p) == pytest.approx((expected.statistic, expected.pvalue))
    assert trapped.test.g > 0
    assert verdicts_by_task(HYPOTHESES, tests)[1].says == "held"


def test_what_fails_is_named():
    tests = compare_methods(results_of({("LA+SA", "slow learner"): OPENED}), PRESET)
    first, second, third = verdicts_by_task(HYPOTHESES, tests)
    assert third.says == second.says == "not held"
    assert third.why.endswith(": LA+SA+Entropy < LA+SA (slow learner)")
    assert ": LA+SA > 0.8 (change after 8 s)" in second.why
    assert first.says == "could not be tested"  # all methods alike
    assert "LA+SA < LA (beta 75) (no spread)" in first.why


@pytest.mark.parametrize("seeds", [1, 2])
def test_few_seeds(seeds):
    errors = {
        (method, person.label): values[:seeds]
        for method, values in zip(METHODS, (ALONE, HELPED, OPENED), strict=True)
        for person in PRESET.people
    }
    tests = compare_methods(results_of(errors), PRESET)
    for test in tests:
        assert (test.p is None) == (seeds == 1)
        assert test.test is None or test.test.g is None
        assert test.n == seeds
    json.dumps([test.as_json() for test in tests], allow_nan=False)


def test_models_are_families_of_their_own():
    both = results_of({}) + results_of({}, model="cvae")
    tests = compare_methods(both, PRESET)
    assert {test.family for test in tests} == {"cae", "cvae"}
    assert len(tests) == 2 * len(compare_methods(results_of({}), PRESET))
    assert [verdict.family for verdict in verdicts_by_task(HYPOTHESES, tests)] == ["cae"] * 3 + ["cvae"] * 3
