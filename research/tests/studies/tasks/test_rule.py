"""The rule for the default decoder, on runs made by hand."""

import pytest

from latentarm_research.studies.tasks.preset import Condition
from latentarm_research.studies.tasks.rule import LEAST, PEOPLE, PRACTISED, SWITCHED, decide
from latentarm_research.studies.tasks.runs import Run

TASKS = ("entree", "pour")
SLOW, FAST, LONG = (Condition("joints", name) for name in ("cae", "cvae", "homogeneous"))
FIT_S = {SLOW: 30.0, FAST: 20.0, LONG: 90.0}


def runs(succeeded, of=20, time_s=10.0):
    """The first of them succeed."""
    return [Run(n, "left", ("above",), int(n < succeeded), n < succeeded, "", "", time_s) for n in range(of)]


def study(**changes):
    """Everything succeeds in all cells, in 20 s by mode switching; changes by model name and person."""
    made = {}
    for task in TASKS:
        for what in (SWITCHED, *FIT_S):
            for person in PEOPLE:
                usual = runs(20, time_s=20.0 if what == SWITCHED else 10.0)
                made.setdefault(task, {})[what.by(person)] = usual
    for name, (task, person, of) in changes.items():
        what = next(one for one in (SWITCHED, *FIT_S) if (one.model or one.name) == name.rstrip("_"))
        for one in [person] if isinstance(person, str) else person:
            made[task][what.by(one)] = of
    return made


def verdict(**changes):
    return decide(study(**changes), FIT_S, TASKS)


def test_with_all_equal_the_one_that_trains_faster_wins():
    found = verdict()
    assert found.chosen == FAST.label
    assert found.sentence == f"{FAST.label} (3 of 3 candidates tied)"
    assert {one.time_ratio for one in found.standings} == {0.5}
    assert {(one.succeeded, one.of) for one in found.standings} == {(200, 200)}


def test_success_comes_before_time_and_two_percent_are_a_tie():
    faster = ("entree", PEOPLE, runs(20, time_s=4.0))
    assert verdict(cae=faster).chosen == SLOW.label
    tied = verdict(cae=faster, cae_=("pour", "learning", runs(16)))
    assert (tied.chosen, tied.standings[0].succeeded) == (SLOW.label, 196)
    lost = verdict(cae=faster, cae_=("pour", "learning", runs(15)))
    assert lost.sentence == f"{FAST.label} (2 of 3 candidates tied)"


def test_a_candidate_that_makes_a_task_worse_for_practised_people_is_out():
    found = verdict(cvae=("pour", "planning", runs(10)), cvae_=("pour", "greedy", runs(18)))
    assert found.standings[1].worse_at == ("pour",)
    assert found.chosen == SLOW.label
    assert "| cVAE, joints | 188 of 200 | 0.50 | 20 | pour |" in found.table()
    # The same failures of newcomers put nobody out, and neither does one by chance.
    newcomers = verdict(cvae=("pour", "learning", runs(10)), cvae_=("pour", "greedy", runs(18)))
    assert newcomers.standings[1].worse_at == ()


def test_no_candidate_may_be_left():
    lost = {name: ("pour", PRACTISED, runs(2)) for name in ("cae", "cvae", "homogeneous")}
    found = verdict(**lost)
    assert found.chosen is None
    assert found.sentence == "not decided: every candidate makes a task worse than mode switching"


def test_all_candidates_are_counted_over_the_same_runs():
    found = verdict(cae=("pour", "reading", runs(8, of=8)))
    assert {one.of for one in found.standings} == {8 * len(PEOPLE) * len(TASKS)}


@pytest.mark.parametrize("number", [0, LEAST - 1])
def test_with_too_few_runs_nothing_is_decided(number):
    found = verdict(homogeneous=("pour", "unsteady", runs(number, of=number)))
    assert found.chosen is None
    place = f"pour, unsteady, {LONG.label}"
    assert found.sentence == f"not decided: {number} runs per cell ({place}), {LEAST} needed"
    assert found.table() == ""


def test_people_who_did_not_drive_are_missed():
    without = {
        task: {what: of for what, of in made.items() if what.person != "reading"}
        for task, made in study().items()
    }
    assert decide(without, FIT_S, TASKS).sentence.startswith("not decided: 0 runs per cell (entree, reading")
