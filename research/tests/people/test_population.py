"""Simulated people: the same seed gives the same people, and their traits are in their ranges."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm_research.people.calibration import BEFORE, Calibration
from latentarm_research.people.population import TRAITS, draw_people
from latentarm_research.people.spread import LogNormal, Normal
from latentarm_research.people.traits import time_share

SEEDS = st.integers(0, 2**31)


@settings(max_examples=10)
@given(SEEDS, st.integers(1, 3), st.integers(0, 3))
def test_the_same_seed_gives_the_same_people_however_many(seed, number, more):
    assert draw_people(number + more, seed)[:number] == draw_people(number, seed)


@settings(max_examples=20)
@given(SEEDS)
def test_traits_are_within_their_ranges(seed):
    for person in draw_people(3, seed):
        for trait in TRAITS:
            assert trait.spread.lowest <= getattr(person, trait.name) <= trait.spread.highest


def test_people_differ_and_their_medians_are_those_stated():
    people = draw_people(400, 1)
    for trait in TRAITS:
        drawn = np.array([getattr(person, trait.name) for person in people])
        assert len(set(drawn)) == len(people)
        assert np.median(drawn) == pytest.approx(trait.spread.at(0.5), abs=0.3 * np.std(drawn))
    assert 0.1 < np.mean([person.mirrored for person in people]) < 0.3


def test_another_calibration_changes_the_fitted_figures_alone():
    slower = Calibration(2.0 * BEFORE.push_variation, 3.0 * BEFORE.switch_s)
    for person, other in zip(draw_people(5, 1, BEFORE), draw_people(5, 1, slower), strict=True):
        assert other.push_variation == pytest.approx(2.0 * person.push_variation)
        assert other.switch_s == pytest.approx(3.0 * person.switch_s)
        assert replace(other, push_variation=person.push_variation, switch_s=person.switch_s) == person


@settings(max_examples=20)
@given(st.integers(0, 50), st.floats(0.0, 3600.0))
def test_trials_and_practice_never_make_a_person_slower_or_less_sure(trial, practice_s):
    traits = draw_people(1, 1)[0]
    now, later = traits.person(trial, practice_s).decides, traits.person(trial + 1, practice_s + 60.0).decides
    assert later.decision_s < now.decision_s
    assert later.switch_s < now.switch_s
    assert later.beta > now.beta
    assert later.horizon_s == now.horizon_s


def test_a_minute_of_practice_is_worth_a_trial():
    assert time_share(0.2, 3, 60.0) == pytest.approx(time_share(0.2, 4))
    assert time_share(0.2, 0) == 1.0
    assert time_share(0.3, 1) == pytest.approx(2.0**-0.3)


def test_a_person_is_the_same_for_every_condition_and_goes_into_a_file():
    traits = draw_people(1, 3)[0]
    assert traits.person(2, 60.0) == traits.person(2, 60.0)
    usual = np.zeros((6, 2))
    shown, newcomer = traits.person(0), traits.newcomer(usual, 0)
    assert (shown.hand, shown.lapses, shown.speed, shown.page, shown.decides) == (
        newcomer.hand,
        newcomer.lapses,
        newcomer.speed,
        newcomer.page,
        newcomer.decides,
    )
    assert json.loads(json.dumps(traits.as_json()))["switch_s"] == traits.switch_s


@settings(max_examples=30)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_quantiles_go_up_and_stay_within_the_ends(one, other):
    low, high = sorted([one, other])
    for spread in (Normal(1.0, 2.0, -3.0, 2.0), LogNormal(1.0, 0.5, 0.5, 4.0)):
        assert spread.lowest <= spread.at(low) <= spread.at(high) <= spread.highest


@pytest.mark.parametrize(("number", "seed"), [(0, 1), (1, -1)])
def test_nobody_and_a_negative_seed_are_refused(number, seed):
    with pytest.raises(UserError):
        draw_people(number, seed)
