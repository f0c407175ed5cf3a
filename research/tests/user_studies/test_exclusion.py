from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from latentarm.core.errors import UserError
from latentarm_research.user_studies.catalogue import load_definition
from latentarm_research.user_studies.exclusion import counted
from latentarm_research.user_studies.record import Trial, read_trial

HARMONIC = load_definition("harmonic")
CONDITIONS = [condition.name for condition in HARMONIC.conditions]
RULES = HARMONIC.exclusions

TRIALS = st.lists(
    st.builds(
        Trial,
        st.integers(0, 3),
        st.sampled_from(CONDITIONS),
        st.just("marshmallows"),
        st.integers(0, 4),
        st.integers(0, 4),
        st.fixed_dictionaries({"input_magnitude": st.floats(0, 0.2)}),
    ),
    max_size=30,
)


@settings(max_examples=30)
@given(TRIALS, st.randoms())
def test_other_conditions_exclude_the_same_trials_and_people(trials: list[Trial], random) -> None:
    shuffled = [one.condition for one in trials]
    random.shuffle(shuffled)
    other = [replace(one, condition=name, order=0) for one, name in zip(trials, shuffled, strict=True)]
    kept, out = counted(RULES, trials)
    kept_other, out_other = counted(RULES, other)
    assert out == out_other
    assert [one.measures for one in kept] == [one.measures for one in kept_other]


@settings(max_examples=30)
@given(TRIALS)
def test_what_counts_keeps_the_rules(trials: list[Trial]) -> None:
    kept, out = counted(RULES, trials)
    assert not any(rule.excludes(one.measures) for rule in RULES for one in kept)
    assert not {one.person for one in kept} & set(out.people)
    assert all(why for _, why in out.trials)
    for person in {one.person for one in trials} - set(out.people):
        mine = [one for one in trials if one.person == person]
        assert sum(one.person == person for one in kept) >= len(mine) / 2


def test_a_trial_is_read_as_it_was_written() -> None:
    trial = Trial(3, "cVAE", "marshmallows", 1, 2, {"time_s": 1.5, "idle_s": float(np.nan)})
    assert read_trial(trial.as_json(), "trial 0") == replace(trial, measures={"time_s": 1.5})
    for name, value in (("person", "x"), ("order", True), ("measures", [1]), ("condition", None)):
        with pytest.raises(UserError, match=f"trial 0: {name}"):
            read_trial({**trial.as_json(), name: value}, "trial 0")
    with pytest.raises(UserError, match="time_s"):
        read_trial({**trial.as_json(), "measures": {"time_s": "fast"}}, "trial 0")
