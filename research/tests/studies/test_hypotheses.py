"""How tests are corrected and told, the same for every study."""

import numpy as np
import pytest

from latentarm_research.studies.hypotheses import Comparison, comparison_table, corrected, verdicts
from latentarm_research.studies.statistics import Statistic


def a_test(subject, against, p=0.5, measure="r2", **others):
    direction = "greater" if measure == "r2" else "less"
    known = {"hypothesis": "H1", "family": "paper", "task": "sine", "model": subject, "n": 3, "n_against": 3}
    return Comparison(
        **{**known, **others},
        measure=measure,
        subject=subject,
        against=against,
        direction=direction,
        mean=2.0,
        mean_against=0.9,
        test="Welch" if p is not None else "none: no spread",
        p=p,
        p_holm=p,
    )


def test_p_is_corrected_within_a_hypothesis_and_a_family():
    given = [a_test("cae", str(k), p, family=family) for k, p in enumerate((0.01, 0.04)) for family in "ab"]
    found = corrected([*given, a_test("cae", "9", 0.03, hypothesis="H2"), a_test("cae", "8", None)])
    assert [(one.hypothesis, one.family, one.p_holm) for one in found] == [
        ("H1", "a", 0.02),
        ("H1", "a", 0.04),
        ("H1", "b", 0.02),
        ("H1", "b", 0.04),
        ("H1", "paper", None),
        ("H2", "paper", 0.03),
    ]
    assert [one.holds for one in found] == [True, True, True, True, False, True]


def test_verdicts_come_family_by_family_and_task_by_task():
    tests = [
        a_test("cae", "ae", 0.01, hypothesis=hypothesis, task=task, family=family)
        for hypothesis in ("H1", "H2")
        for family in "ab"
        for task in ("sine", "reach")
    ]
    tests[-1] = a_test("cae", "ae", 0.2, hypothesis="H2", task="reach", family="b")
    found = verdicts(tests)
    assert [(one.family, one.hypothesis) for one in found] == [
        ("a", "H1"),
        ("a", "H2"),
        ("b", "H1"),
        ("b", "H2"),
    ]
    assert all(one.by_task == {"sine": "supported", "reach": "supported"} for one in found[:3])
    assert found[-1].by_task == {"sine": "supported", "reach": "not supported: cAE not clearly above AE"}


@pytest.mark.parametrize(
    ("tests", "said"),
    [
        (
            [a_test(model, other, measure="drift") for model in ("cae", "scl") for other in ("ae", "vae")]
            + [a_test("scl", None)],
            "cAE and SCL not clearly below AE and VAE in drift; SCL not clearly above 0.9 in r2",
        ),
        (
            [a_test("cae", "ae"), a_test("scl", "ae", p=None)],
            "cAE not clearly above AE; SCL could not be tested against AE",
        ),
        (
            [a_test("cae", "ae", where=f"noise {noise:g}") for noise in (0.0, 0.5)],
            "cAE not clearly above AE (noise 0 and noise 0.5)",
        ),
        (
            [a_test(f"model {k}", f"model {2 * k}", where=f"beta {k}") for k in range(10)]
            + [a_test("cae", "ae", 0.001)],
            "10 of 11 tests do not hold, in r2",
        ),
    ],
)
def test_what_failed_is_named(tests, said):
    (verdict,) = verdicts(tests)
    assert verdict.by_task["sine"] == f"not supported: {said}"


def test_intervals_that_overlap_are_not_enough_where_they_must_be_apart():
    widths = {"half_width": 0.6, "half_width_against": 0.6}
    assert not a_test("cae", "ae", 0.001, **widths, must_be_apart=True).holds
    assert a_test("cae", "ae", 0.001, **widths).holds
    assert a_test("cae", "ae", 0.001, half_width=0.5, half_width_against=0.5, must_be_apart=True).holds
    assert a_test("cae", "ae").apart is None


def test_a_statistic_is_taken_over():
    one = a_test("cae", "ae").tested(Statistic("McNemar", p=0.25))
    assert (one.test, one.p, one.t, one.hedges_g) == ("McNemar", 0.25, None, None)
    assert {type(value) for value in one.as_json().values()} <= {str, bool, int, float, type(None)}
    assert np.isfinite(one.as_json()["p"])


def test_the_table_leaves_out_what_says_nothing():
    head = comparison_table([a_test("cae", "ae")]).splitlines()[0]
    assert head == "|  | task | what | against | test | t (dof) | p, Holm | Hedges' g | holds |"
    told = comparison_table([a_test("LA", None, model="cae", where="beta 75", half_width=0.1)]).splitlines()
    assert "| model | where | what |" in told[0]
    assert "| cAE | beta 75 | LA 2.00 ± 0.10 | > 0.9 | Welch |" in told[2]
