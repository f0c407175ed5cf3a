"""What the study is to show, met or missed, with the figures that decide it."""

from collections.abc import Sequence
from typing import Final

from latentarm.evaluation.looks import look_of
from latentarm_research.studies.shared_autonomy.cell import WITH_ENTROPY, WITH_HELP
from latentarm_research.studies.shared_autonomy.hypotheses import MEASURE
from latentarm_research.studies.shared_autonomy.preset import Preset, learner
from latentarm_research.studies.shared_autonomy.rows import Figure, Interval
from latentarm_research.studies.targets import Target

AT_LEAST: Final = 0.9
"""Final state error without entropy after the latest change of mind: people are trapped at the other cup."""

AT_MOST: Final = 0.1
"""The same with entropy: they are at theirs."""


def targets(found: Sequence[Figure], preset: Preset) -> list[Target]:
    """Every target, by what is asked for, then by arm and model."""
    errors = {(one.task, one.model, one.condition): one.interval for one in found if one.measure == MEASURE}
    latest = preset.latest_change.label
    judged: list[Target] = []
    for task, model in dict.fromkeys((task, model) for task, model, _ in errors):
        where = look_of(task).label, look_of(model).label
        helped, opened = (errors[task, model, f"{method}, {latest}"] for method in (WITH_HELP, WITH_ENTROPY))
        trapped = f"{latest}: {WITH_HELP} at least {AT_LEAST:g}"
        free = f"{latest}: {WITH_ENTROPY} at most {AT_MOST:g}"
        judged.append(Target(trapped, helped.mean >= AT_LEAST, _written(helped), where))
        judged.append(Target(free, opened.mean <= AT_MOST, _written(opened), where))
        for name, slope in preset.learners.items():
            person = learner(name, slope).label
            helped, opened = (
                errors[task, model, f"{method}, {person}"] for method in (WITH_HELP, WITH_ENTROPY)
            )
            figures = f"{_written(helped)} and {_written(opened)}"
            judged.append(Target(f"{person}: intervals apart", opened.high < helped.low, figures, where))
    order = list(dict.fromkeys(one.name for one in judged))
    return sorted(judged, key=lambda one: order.index(one.name))


def _written(error: Interval) -> str:
    return f"{error.mean:.3f} ± {error.half_width:.3f}"
