"""Studies in which each person meets one condition."""

import json
from collections import Counter
from dataclasses import replace
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import nct, ttest_ind
from statsmodels.stats.weightstats import ttost_ind

from drawn_trials import drawn_trials
from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm_research.studies.statistics import welch_test
from latentarm_research.user_studies.analysis.analysis import analyse
from latentarm_research.user_studies.analysis.anova import between_people
from latentarm_research.user_studies.analysis.randomisation import permutation_p
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.designs import assigned
from latentarm_research.user_studies.power import NUMBERS, power_of
from latentarm_research.user_studies.record import Trial
from latentarm_research.user_studies.recorded import PeopleAre, Recorded
from latentarm_research.user_studies.report.page import report_of
from latentarm_research.user_studies.sizes import PRESETS

PIE = replace(load_definition("apple_pie"), name="pie_apart", design="between", printed=())
EATING = replace(load_definition("eating"), name="eating_apart", design="between")

GROUP = st.lists(st.floats(-100, 100).map(lambda value: round(value, 9)), min_size=2, max_size=8).map(
    np.array
)
"""Of figures whose squares do not underflow in the libraries that we compare with."""


@settings(max_examples=30)
@given(st.integers(2, 6), st.integers(1, 30), st.integers(0, 100))
def test_every_block_of_people_has_each_condition_once(count: int, people: int, seed: int) -> None:
    names = [f"c{index}" for index in range(count)]
    found = assigned(names, people, np.random.default_rng(seed))
    assert len(found) == people
    assert found == assigned(names, people, np.random.default_rng(seed))
    for start in range(0, people - people % count, count):
        assert sorted(found[start : start + count]) == names
    met = Counter(found)
    assert max(met.values()) - min(met[name] for name in names) <= 1


@pytest.mark.filterwarnings("ignore:Precision loss")  # SciPy's, of a group that hardly varies
@settings(max_examples=40)
@given(GROUP, GROUP)
def test_welch_agrees_with_scipy_and_statsmodels(subject: FloatArray, against: FloatArray) -> None:
    test = welch_test(subject, against)
    if test is None:
        return
    expected = ttest_ind(subject, against, equal_var=False)
    low, high = expected.confidence_interval()
    assert (test.t, test.dof, test.p) == pytest.approx((expected.statistic, expected.df, expected.pvalue))
    assert test.interval == pytest.approx((low, high), rel=1e-6, abs=1e-6)
    margin = 1.5 * subject.std() + 1.0
    p = ttost_ind(subject, against, -margin, margin, usevar="unequal")[0]
    assert test.p_of_equality(margin) == pytest.approx(p, abs=1e-9)


@given(GROUP, GROUP, st.integers(-300, 300))
def test_welch_is_the_same_in_any_unit(subject: FloatArray, against: FloatArray, exponent: int) -> None:
    test, other = welch_test(subject, against), welch_test(subject * 2.0**exponent, against * 2.0**exponent)
    if test is None or other is None:
        assert test is other
        return
    assert (test.t, test.dof, test.p) == pytest.approx((other.t, other.dof, other.p))


@settings(max_examples=30)
@given(st.floats(0.05, 3), st.integers(2, 20), st.integers(2, 20))
def test_an_interval_ends_where_the_observed_effect_is_as_rare_as_it_says(d: float, n: int, m: int) -> None:
    subject, against = (np.resize([-1.0, 1.0], count) for count in (n, m))
    subject = subject + d
    test = welch_test(subject, against)
    assert test is not None
    low, high = test.effect_interval
    root = np.sqrt(n * m / (n + m))
    t = test.d * root
    assert nct.cdf(t, n + m - 2, low * root) == pytest.approx(0.975, abs=1e-4)
    assert nct.cdf(t, n + m - 2, high * root) == pytest.approx(0.025, abs=1e-4)


@pytest.mark.parametrize("each", range(2, 8))
def test_groups_that_do_not_overlap_are_as_rare_as_one_in_all_groups(each: int) -> None:
    low = np.arange(each) * 1.0
    p = permutation_p(low, low + 100.0)
    assert p == pytest.approx(2.0 / comb(2 * each, each))
    assert permutation_p(low + 100.0, low) == pytest.approx(p)
    assert permutation_p(low, low) == pytest.approx(1.0)


def test_each_person_counts_on_one_side() -> None:
    trials = drawn_trials(PIE, 12, np.random.default_rng(3), {"cVAE": -8.0})
    analysis = analyse(PIE, trials)
    json.dumps(analysis.as_json(), allow_nan=False)
    json.dumps([one.as_json() for one in analysis.claims], allow_nan=False)
    timed = next(one.tested for one in analysis.claims if one.tested.claim.measure == "time_s")
    assert (timed.n, timed.n_against, timed.says) == (6, 6, "held")
    assert timed.test is not None
    assert (timed.test.n, timed.test.n_against) == (6, 6)
    assert timed.test.g == pytest.approx(timed.test.d * 0.9228, rel=1e-3)
    rated = next(one.tested for one in analysis.claims if one.tested.claim.measure == "ease")
    assert rated.why_not == "nobody has a figure for it"
    # A single trial of a person does not tell the person from chance.
    assert analysis.claims[0].mixed is None


def recorded(trials: list[Trial], people_are: PeopleAre, preset: str) -> Recorded:
    return Recorded(PIE, people_are, tuple(trials), (), (), PRESETS[preset])


def test_a_report_says_who_met_what() -> None:
    trials = drawn_trials(PIE, 8, np.random.default_rng(5), {"cVAE": -2.0})
    page = report_of(recorded(trials, "real", "paper"), "latentarm study").page
    assert "one condition (between subjects)" in page
    assert "4 + 4" in page
    assert "Welch" in page
    assert "paired" not in page.lower()


def test_factors_between_people_agree_with_a_linear_model() -> None:
    import pandas as pd
    from statsmodels.formula.api import ols
    from statsmodels.stats.anova import anova_lm

    trials = drawn_trials(EATING, 15, np.random.default_rng(7), {"LA+SA": -1.5, "LA": -0.5})
    control, assistance = EATING.factors
    effects = between_people(trials, (control, assistance), "time_s", ("entree", "dessert"))
    met = {one.person: one.condition for one in trials}
    means = {
        person: np.mean(
            [
                np.mean(
                    [one.measures["time_s"] for one in trials if (one.person, one.task) == (person, task)]
                )
                for task in ("entree", "dessert")
            ]
        )
        for person in met
    }
    frame = pd.DataFrame(
        {"value": means[one], "c": name.startswith("LA"), "a": name.endswith("SA")}
        for one, name in met.items()
    )
    table = anova_lm(ols("value ~ C(c, Sum) * C(a, Sum)", frame).fit(), typ=3)
    assert [one.f for one in effects] == pytest.approx(table["F"].tolist()[1:4])
    assert [one.p for one in effects] == pytest.approx(table["PR(>F)"].tolist()[1:4])
    assert {one.dof_error for one in effects} == {11}


def test_power_draws_people_condition_by_condition() -> None:
    trials = drawn_trials(PIE, 12, np.random.default_rng(4), {"cVAE": -3.0})
    power = power_of(PIE, trials, 10, seed=0)
    assert power.numbers == tuple(2 * number for number in NUMBERS)
    shares = next(shares for name, shares in power.claims.items() if name.startswith("time"))
    assert shares[-1] == 1.0
    with pytest.raises(UserError, match="4 people for 2 conditions"):
        power_of(PIE, drawn_trials(PIE, 4, np.random.default_rng(4)), 10, seed=0)


def test_orders_make_no_sense_where_people_meet_one_condition() -> None:
    with pytest.raises(UserError, match="leave them empty"):
        replace(load_definition("case_study"), design="between")


def test_a_smoke_run_says_so_tells_what_was_run_and_judges_nothing() -> None:
    trials = drawn_trials(PIE, 8, np.random.default_rng(5), {"cVAE": -2.0})
    report = report_of(recorded(trials, "simulated", "smoke"), "latentarm study")
    analysis = report.documents["analysis.json"]
    assert isinstance(analysis, dict)
    assert {one["says"] for one in analysis["hypotheses"]} == {"could not be tested"}
    page = report.page
    assert page.startswith(f"# {PIE.title} (preset smoke)\n")
    assert all("(preset smoke)" in line for line in page.splitlines() if line.startswith("What became"))
    assert "for 1 s per part" in page
    assert "240 s" not in page
    assert "| held |" not in page
    assert "| not held |" not in page
