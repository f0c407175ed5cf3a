"""What the study is to show, met or missed, with the figures that decide it."""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from latentarm.evaluation.looks import look_of
from latentarm_research.studies.shared_autonomy.cell import WITH_ENTROPY, WITH_HELP
from latentarm_research.studies.shared_autonomy.hypotheses import MEASURE
from latentarm_research.studies.shared_autonomy.intervals import Interval
from latentarm_research.studies.shared_autonomy.preset import Person, Preset, learner
from latentarm_research.studies.shared_autonomy.rows import Figure
from latentarm_research.studies.tables import markdown_table

AT_LEAST: Final = 0.9
"""Final state error without entropy after the latest change of mind: people are trapped at the other cup."""

AT_MOST: Final = 0.1
"""The same with entropy: they are at theirs."""


class AutonomyTarget(NamedTuple):
    """One target with one model on one arm."""

    said: str  # what is asked for
    task: str  # the arm's task
    model: str
    found: str  # the figures that decide it
    met: bool  # whether they are as asked for


def targets(found: Sequence[Figure], preset: Preset) -> list[AutonomyTarget]:
    """Every target, by what is asked for, then by arm and model."""
    errors = {(one.task, one.model, one.condition): one.interval for one in found if one.measure == MEASURE}
    places = list(dict.fromkeys((task, model) for task, model, _ in errors))
    return [
        *(_trapped(errors, preset.latest_change, *place) for place in places),
        *(_free(errors, preset.latest_change, *place) for place in places),
        *(
            _apart(errors, learner(name, slope), *place)
            for name, slope in preset.learners.items()
            for place in places
        ),
    ]


def target_table(wanted: Sequence[AutonomyTarget]) -> str:
    """All targets, in Markdown."""
    return markdown_table(["target", "arm", "model", "found", ""], list(_lines(wanted)))


def _lines(wanted: Sequence[AutonomyTarget]) -> Iterator[list[str]]:
    for one in wanted:
        met = "met" if one.met else "**missed**"
        yield [one.said, look_of(one.task).label, look_of(one.model).label, one.found, met]


Errors = dict[tuple[str, str, str], Interval]
"""Final state errors by task, model and condition."""


def _trapped(errors: Errors, person: Person, task: str, model: str) -> AutonomyTarget:
    error = errors[task, model, f"{WITH_HELP}, {person.label}"]
    said = f"{person.label}: {WITH_HELP} at least {AT_LEAST:g}"
    return AutonomyTarget(said, task, model, _written(error), error.mean >= AT_LEAST)


def _free(errors: Errors, person: Person, task: str, model: str) -> AutonomyTarget:
    error = errors[task, model, f"{WITH_ENTROPY}, {person.label}"]
    said = f"{person.label}: {WITH_ENTROPY} at most {AT_MOST:g}"
    return AutonomyTarget(said, task, model, _written(error), error.mean <= AT_MOST)


def _apart(errors: Errors, person: Person, task: str, model: str) -> AutonomyTarget:
    helped, opened = (
        errors[task, model, f"{method}, {person.label}"] for method in (WITH_HELP, WITH_ENTROPY)
    )
    found = f"{_written(helped)} and {_written(opened)}"
    return AutonomyTarget(f"{person.label}: intervals apart", task, model, found, opened.high < helped.low)


def _written(error: Interval) -> str:
    return f"{error.mean:.3f} ± {error.half_width:.3f}"
