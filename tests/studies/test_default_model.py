"""The rule for the default model, by hand."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from latentarm.errors import UserError
from latentarm.models.catalogue import KINDS
from latentarm.studies.default_model import Candidate, choose, leader, may_stay, success_interval

STARTS, PEOPLE = 30, 4


def candidate(name, failed=0, time_s=10.0, train_s=5.0):
    """A model with which everybody fails from the first so many starts, in a minute each."""
    success = np.ones((STARTS, PEOPLE), dtype=bool)
    success[:failed] = False
    took = np.random.default_rng(len(name)).normal(time_s, 0.1, success.shape)
    return Candidate(KINDS[name], success, np.where(success, took, 60.0), train_s)


def chosen(*candidates):
    return choose(candidates)[-1].kept


def test_success_comes_before_everything_else():
    assert chosen(candidate("cae", time_s=30.0, train_s=99.0), candidate("homogeneous", failed=15)) == (
        "cae",
    )


def test_among_models_that_succeed_as_often_time_decides():
    steps = choose([candidate("homogeneous", failed=1, time_s=20.0), candidate("cvae")])
    assert steps[0].kept == ("homogeneous", "cvae")
    assert steps[1].kept == steps[-1].kept == ("cvae",)
    assert steps[1].figures["cvae"] == "1.00 [1.00, 1.00]"


def test_a_few_failures_do_not_decide_but_their_time_counts():
    # One failure in 30 starts: intervals overlap, and the time of the others is the same.
    assert choose([candidate("cae", failed=1), candidate("cvae")])[1].kept == ("cae", "cvae")


def test_among_equals_what_holds_by_construction_decides_then_the_training():
    equal = [candidate(name, train_s=train_s) for name, train_s in (("cvae", 1), ("scl", 9), ("odd_cae", 2))]
    rng = np.random.default_rng(0)
    equal = [
        Candidate(one.kind, one.success, np.exp(rng.normal(2.0, 0.3, one.time_s.shape)), one.train_s)
        for one in equal
    ]
    steps = choose(equal)
    assert steps[1].kept == ("cvae", "scl", "odd_cae")
    assert steps[2].kept == tuple(one.kind.name for one in equal if one.kind.reverses)
    assert steps[3].kept == (
        min((one for one in equal if one.kind.reverses), key=lambda one: one.train_s).kind.name,
    )


def test_one_model_is_chosen_and_all_steps_name_what_they_looked_at():
    steps = choose([candidate("scl"), candidate("cae", failed=3), candidate("cvae", time_s=11.0)])
    assert len(steps[-1].kept) == 1
    assert set(steps[0].figures) == {"scl", "cae", "cvae"}
    assert all(set(after.figures) == set(before.kept) for before, after in pairwise(steps))


def test_drives_that_differ_are_not_compared():
    other = candidate("cae")
    with pytest.raises(UserError, match="same people"):
        choose([candidate("scl"), Candidate(other.kind, other.success[:9], other.time_s[:9], 1.0)])
    with pytest.raises(UserError, match="same people"):
        choose([])


def test_a_candidate_that_cannot_reach_the_best_any_more_may_not_stay():
    best, behind, close = candidate("scl"), candidate("cae", failed=9), candidate("cvae", failed=1)
    assert leader([behind, best, close]) is best
    assert not may_stay(behind, best)
    assert may_stay(close, best)
    assert choose([best, behind, close])[0].kept == ("scl", "cvae")


def test_further_success_never_lowers_the_interval():
    before = candidate("cae", failed=20)
    after = replace(before, success=before.success | (np.arange(STARTS) % 3 == 0)[:, None])
    assert success_interval(after)[0] >= success_interval(before)[0]
    assert success_interval(after)[1] >= success_interval(before)[1]
