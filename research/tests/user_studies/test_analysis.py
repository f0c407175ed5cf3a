import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import nct
from scipy.stats import t as student

from drawn_trials import drawn_trials
from latentarm.core.types import FloatArray
from latentarm_research.studies.claims import Claim
from latentarm_research.studies.statistics import MeansTest, one_sample_test, small_sample_correction
from latentarm_research.user_studies.analysis.analysis import (
    analyse,
    claims_tested,
    mixed_model,
    sides_of,
    verdicts,
)
from latentarm_research.user_studies.analysis.anova import repeated_measures
from latentarm_research.user_studies.analysis.as_printed import as_printed
from latentarm_research.user_studies.analysis.means import long_table, sides
from latentarm_research.user_studies.analysis.randomisation import randomisation_p
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.hypothesis import Printed
from latentarm_research.user_studies.record import Trial

SLEEP = np.array([1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4])
"""Additional hours of sleep with one drug and with the other, differences of ten people (Student 1908)."""

EATING = load_definition("eating")
HARMONIC = load_definition("harmonic")
FASTER = Claim("time_s", ("LA",), ("R",), "less")

DIFFERENCES = st.lists(st.floats(-100, 100), min_size=3, max_size=15).map(np.array)


def two_sided(subject: FloatArray, against: FloatArray) -> list[Trial]:
    """One trial of each person on either side of `FASTER`, orders in turn."""
    return [
        Trial(person, condition, "entree", (person + place) % 2, 0, {"time_s": float(values[person])})
        for person in range(len(subject))
        for place, (condition, values) in enumerate((("LA", subject), ("R", against)))
    ]


def test_the_paired_test_of_student() -> None:
    test = one_sample_test(SLEEP)
    assert test is not None
    assert (test.n, test.dof) == (10, 9)
    assert test.t == pytest.approx(4.0621, abs=5e-5)
    assert test.p == pytest.approx(0.002833, abs=5e-7)
    assert test.interval == pytest.approx((0.7001142, 2.4598858), abs=5e-7)
    assert test.d == pytest.approx(test.t / np.sqrt(10))


def test_the_correction_of_hedges() -> None:
    # Table 2 of Hedges (1981).
    assert small_sample_correction(2) == pytest.approx(0.5642, abs=5e-5)
    assert small_sample_correction(10) == pytest.approx(0.9228, abs=1e-4)
    assert small_sample_correction(50) == pytest.approx(0.9849, abs=5e-5)


@settings(max_examples=30)
@given(st.floats(0.01, 3), st.integers(2, 40))
def test_an_interval_of_dz_ends_where_the_observed_one_is_as_rare_as_it_says(dz: float, n: int) -> None:
    low, high = MeansTest(n, 0, dz, 1.0, n - 1, dz).effect_interval
    t = dz * np.sqrt(n)
    assert low < high
    assert nct.cdf(t, n - 1, low * np.sqrt(n)) == pytest.approx(0.975, abs=1e-4)
    assert nct.cdf(t, n - 1, high * np.sqrt(n)) == pytest.approx(0.025, abs=1e-4)
    assert (-high, -low) == pytest.approx(MeansTest(n, 0, -dz, 1.0, n - 1, -dz).effect_interval, abs=1e-4)


@settings(max_examples=40)
@given(DIFFERENCES)
def test_swapping_the_sides_turns_the_sign_and_nothing_else(differences: FloatArray) -> None:
    test, swapped = one_sample_test(differences), one_sample_test(-differences)
    if test is None or swapped is None:
        assert test is swapped
        return
    assert (swapped.t, swapped.d, swapped.interval[0]) == pytest.approx((-test.t, -test.d, -test.interval[1]))
    assert swapped.p == pytest.approx(test.p)
    low, high = test.interval
    assert low <= test.difference <= high
    assert (low > 0 or high < 0) == (test.p < 0.05)


def test_equivalence_is_the_worse_of_two_one_sided_tests() -> None:
    se = SLEEP.std(ddof=1) / np.sqrt(10)
    worse = student.cdf((SLEEP.mean() - 3.0) / se, 9)
    test = one_sample_test(SLEEP)
    assert test is not None
    assert test.p_of_equality(3.0) == pytest.approx(worse)
    assert worse == pytest.approx(0.00266, abs=5e-5)
    assert test.p_of_equality(1.0) > 0.5


@pytest.mark.parametrize("people", range(2, 10))
def test_a_difference_that_all_share_is_as_rare_as_one_in_all_swaps(people: int) -> None:
    against = np.arange(people) * 3.0
    table = long_table(two_sided(against - 1.0 - 1e-3 * against**2, against), FASTER, on_both=True)
    plain = replace(table, covariates=table.covariates[:, :0])
    assert randomisation_p(plain) == pytest.approx(2.0 ** (1 - people))


def test_the_randomisation_test_does_not_know_which_side_is_which() -> None:
    trials = drawn_trials(HARMONIC, 8, np.random.default_rng(3), {"cVAE": -0.5})
    claim = Claim("time_s", ("cVAE",), ("High Assist",), "less")
    turned = Claim("time_s", ("High Assist",), ("cVAE",), "less")
    p = randomisation_p(long_table(trials, claim, on_both=True))
    assert p is not None
    assert 0 < p <= 1
    assert randomisation_p(long_table(trials, turned, on_both=True)) == pytest.approx(p)


def test_the_mixed_model_of_balanced_trials_finds_the_difference_of_the_means() -> None:
    trials = drawn_trials(HARMONIC, 12, np.random.default_rng(5), {"cVAE": -2.0})
    claim = Claim("time_s", ("cVAE",), ("No Assist",), "less")
    table = long_table(trials, claim, on_both=True)
    without_order = mixed_model(replace(table, covariates=table.covariates[:, :0]))
    assert without_order is not None
    assert without_order.estimate == pytest.approx(float(sides(trials, claim).differences.mean()), rel=1e-6)
    assert without_order.residual_sd == pytest.approx(1.0, abs=0.25)
    assert without_order.person_sd == pytest.approx(2.0, abs=1.5)
    model = mixed_model(table)
    assert model is not None
    assert model.estimate == pytest.approx(-2.0, abs=3 * model.se)


def test_a_factor_of_two_levels_is_the_square_of_its_paired_t() -> None:
    trials = drawn_trials(EATING, 9, np.random.default_rng(7), {"LA+SA": -1.5, "LA": -0.5})
    control, assistance = EATING.factors
    effects = repeated_measures(trials, (control, assistance), "time_s", ("entree", "dessert"))
    assert [effect.name for effect in effects] == [
        "Control Interface",
        "Robot Assistance",
        "Control Interface x Robot Assistance",
    ]
    assert {(effect.dof, effect.dof_error) for effect in effects} == {(1, 8)}
    for effect, factor in zip(effects, EATING.factors, strict=False):
        test = one_sample_test(
            sides(trials, Claim("time_s", factor.high[1], factor.low[1], "less")).differences
        )
        assert test is not None
        assert effect.f == pytest.approx(test.t**2)
        assert effect.p == pytest.approx(test.p)


def test_the_papers_degrees_of_freedom_come_out_as_the_paper_has_them() -> None:
    own, others = np.arange(50.0), np.arange(110.0) + 40.0
    trials = [
        Trial(int(index) % 10, condition, "marshmallows", 0, 0, {"time_s": float(value)})
        for condition, values in (("cVAE", own), ("High Assist", others))
        for index, value in enumerate(values)
    ]
    of_trials = next(one for one in HARMONIC.printed if one.measure == "time_s")
    found = as_printed(of_trials, trials)
    assert found.text.startswith("t(158) = ")
    assert (found.less, found.same_sign, found.same_significance) == (True, True, True)
    ten = drawn_trials(EATING, 10, np.random.default_rng(0), {"R+SA": -3.0, "LA+SA": -3.0})
    of_halves = next(one for one in EATING.printed if one.test == "between F")
    found = as_printed(of_halves, ten)
    assert found.text.startswith("F(1, 18) = ")
    assert found.same_sign


def test_what_nobody_measured_is_not_compared() -> None:
    trials = drawn_trials(EATING, 4, np.random.default_rng(0), measures=["time_s"])
    unmeasured = Printed("paired t", "easy", ("LA",), ("R",), "t(10) = 2.7", False, True)
    found = as_printed(unmeasured, trials)
    assert (found.text, found.same_sign, found.same_significance) == ("not measured", None, None)


@pytest.mark.parametrize("name", ["apple_pie", "case_study"])
def test_a_study_is_analysed_to_json_without_opinions(name: str) -> None:
    definition = load_definition(name)
    analysis = analyse(definition, drawn_trials(definition, 6, np.random.default_rng(1)))
    json.dumps(analysis.as_json(), allow_nan=False)
    rated = {
        one.tested.hypothesis for one in analysis.claims if one.tested.claim.measure in definition.scales
    }
    for verdict in analysis.verdicts:
        if verdict.hypothesis.name in rated or not verdict.hypothesis.claims:
            assert verdict.says == "could not be tested"


def test_a_hypothesis_holds_only_where_every_claim_does_its_way() -> None:
    def said(effect: float) -> list[str]:
        trials = drawn_trials(EATING, 12, np.random.default_rng(2), {"LA+SA": effect, "R+SA": effect / 2})
        tested = claims_tested(EATING, sides_of(EATING, trials))
        assert all(one.p_holm >= one.p for one in tested if one.p is not None and one.p_holm is not None)
        return [verdict.says for verdict in verdicts(EATING, tested)]

    assert said(-8.0) == ["held", "not held", "held"]
    assert said(8.0)[0] == said(8.0)[2] == "not held"


def test_a_person_without_one_side_does_not_count_for_that_claim() -> None:
    trials = two_sided(np.array([1.0, 2.0, 4.0]), np.array([3.0, 3.0, 3.0]))
    without = [one for one in trials if (one.person, one.condition) != (1, "R")]
    found = sides(without, FASTER)
    assert found.people == (0, 2)
    assert found.differences.tolist() == [-2.0, 1.0]
