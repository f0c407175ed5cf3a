"""How claims are corrected, judged and tabled, the same for every study."""

import json

import numpy as np
import pytest

from latentarm_research.studies import claims  # pytest would take an imported `Tested` for a test
from latentarm_research.studies.claim_tables import (
    claim_table,
    columns_table,
    verdict_columns,
    verdicts_by_task,
)
from latentarm_research.studies.claims import NAMED, Claim, Hypothesis, corrected_by_family
from latentarm_research.studies.statistics import Statistic

HYPOTHESES = tuple(
    Hypothesis(name, f"{name} in words", (Claim("r2", ("a",), ("b",), "greater"),)) for name in ("H1", "H2")
)


def a_test(subject, against, p=0.5, measure="r2", task="sine", **others):
    claim = Claim(measure, (subject,), (against,), "greater" if measure == "r2" else "less", (task,))
    known = {"hypothesis": "H1", "family": "paper", "n": 3, "n_against": 3, "mean": 2.0, "mean_against": 0.9}
    reason = {} if p is not None else {"why_not": "no spread"}
    return claims.Tested(**{**known, **reason, **others}, claim=claim, method="Welch's t", p=p, p_holm=p)


def test_p_is_corrected_within_a_hypothesis_and_a_family():
    given = [a_test("cae", str(k), p, family=family) for k, p in enumerate((0.01, 0.04)) for family in "ab"]
    more = [a_test("cae", "9", 0.03, hypothesis="H2"), a_test("cae", "8", None)]
    found = corrected_by_family([*given, *more])
    assert [(one.hypothesis, one.family, one.p_holm) for one in found] == [
        ("H1", "a", 0.02),
        ("H1", "a", 0.04),
        ("H1", "b", 0.02),
        ("H1", "b", 0.04),
        ("H1", "paper", None),
        ("H2", "paper", 0.03),
    ]
    assert [one.says == "held" for one in found] == [True, True, True, True, False, True]


def test_a_claim_holds_only_its_way():
    assert a_test("cae", "ae", 0.001).says == "held"
    assert a_test("cae", "ae", 0.001, mean=0.1).says == "not held"
    assert a_test("cae", "ae", 0.001, measure="drift").says == "not held"
    assert a_test("cae", "ae", 0.05).says == "not held"
    assert a_test("cae", "ae", None).says == "could not be tested"


def test_intervals_that_overlap_are_not_enough_where_they_must_be_apart():
    assert a_test("cae", "ae", 0.001, apart=False).says == "not held"
    assert a_test("cae", "ae", 0.001, apart=True).says == "held"


def test_verdicts_come_family_by_family_and_task_by_task():
    tests = [
        a_test("cae", "ae", 0.01, hypothesis=hypothesis, task=task, family=family)
        for hypothesis in ("H1", "H2")
        for family in "ab"
        for task in ("sine", "reach")
    ]
    tests[-1] = a_test("cae", "ae", 0.2, hypothesis="H2", task="reach", family="b")
    found = verdicts_by_task(HYPOTHESES, tests)
    assert [(one.family, one.hypothesis.name, one.task) for one in found] == [
        (family, hypothesis, task)
        for family in "ab"
        for hypothesis in ("H1", "H2")
        for task in ("sine", "reach")
    ]
    assert all((one.says, one.why) == ("held", "all 1 claims hold") for one in found[:-1])
    assert found[-1].says == "not held"
    assert found[-1].why.startswith("1 of 1 claims do not hold: ")
    assert found[-1].why.endswith(": cAE > AE")


@pytest.mark.parametrize(
    ("tests", "says", "why"),
    [
        (
            [a_test("cae", "ae"), a_test("scl", "ae", p=None), a_test("cae", "vae", 0.01)],
            "not held",
            "1 of 3 claims do not hold: R², mean of axes (sine): cAE > AE",
        ),
        (
            [a_test("cae", "0.9", p=None, where="noise 0.5"), a_test("cae", "vae", 0.01)],
            "could not be tested",
            "1 of 2 claims could not be tested: R², mean of axes (sine): cAE > 0.9 (noise 0.5) (no spread)",
        ),
    ],
)
def test_what_failed_is_named(tests, says, why):
    (verdict,) = verdicts_by_task(HYPOTHESES, tests)
    assert (verdict.says, verdict.why) == (says, why)


def test_a_verdict_names_so_many_claims_and_counts_the_others():
    tests = [a_test(f"model {k}", "ae") for k in range(NAMED + 5)]
    (verdict,) = verdicts_by_task(HYPOTHESES, tests)
    assert f"model {NAMED - 1} > AE; 5 more" in verdict.why


def test_a_statistic_is_taken_over():
    statistic = Statistic("McNemar", p=0.25)
    one = a_test("cae", "ae").of(np.array([1.0, 0.0]), np.array([0.0]), statistic)
    assert (one.method, one.p, one.test) == ("McNemar", 0.25, None)
    assert (one.n, one.mean, one.n_against, one.mean_against, one.sd_against) == (2, 0.5, 1, 0.0, None)
    assert json.loads(json.dumps(one.as_json(), allow_nan=False))["says"] == one.says


def test_tables_leave_out_columns_with_nothing_in_them():
    plain = claim_table([a_test("cae", "ae")]).splitlines()[0]
    assert "where" not in plain
    assert "apart" not in plain
    told = claim_table([a_test("LA", "0.9", where="beta 75", apart=True)]).splitlines()
    assert "| family | where | Hedges' g | apart | says |" in told[0]
    assert "LA > 0.9" in told[2]
    assert "| beta 75 | – | yes | not held |" in told[2]
    verdicts = verdicts_by_task(HYPOTHESES, [a_test("cae", "ae", family="")])
    assert columns_table(verdict_columns(verdicts)).startswith("|  | hypothesis | task | says | why |")
