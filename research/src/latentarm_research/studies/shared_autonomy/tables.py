"""The study's tables, in Markdown."""

from collections.abc import Sequence
from typing import final

from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import ABSENT, format_figure
from latentarm_research.studies.shared_autonomy.cell import METHODS
from latentarm_research.studies.shared_autonomy.preset import Preset
from latentarm_research.studies.shared_autonomy.rows import EXTRA_TIME, PAPER, RECONSTRUCTION, Figure
from latentarm_research.studies.tables import grid_table, heading


@final
class Tables:
    """The tables of the page, in Markdown: means with their intervals."""

    def __init__(self, found: Sequence[Figure], preset: Preset) -> None:
        self._found = {(one.task, one.model, one.condition, one.measure): one for one in found}
        self._people = {person.label: person.label for person in preset.people}
        self._models = list(dict.fromkeys(one.model for one in found))

    def people(self, task: str, model: str, measure: str) -> str:
        """One measure with one model: people down, methods across."""

        def text(person: str, method: str) -> str:
            return self._figure(task, model, f"{method}, {person}", measure)

        return grid_table(heading(measure), self._people, {name: name for name in METHODS}, text)

    def extra_time(self, task: str) -> str:
        """How much more time LA takes than LA+SA, with the paper's figures."""

        def text(person: str, model: str) -> str:
            printed = PAPER.get((task, model, EXTRA_TIME, person))
            beside = "" if printed is None else f" (paper: {printed:g})"
            return self._figure(task, model, person, EXTRA_TIME) + beside

        models = {look_of(model).label: model for model in self._models}
        return grid_table(heading(EXTRA_TIME), self._people, models, text)

    def reconstruction(self, tasks: Sequence[str]) -> str:
        """Reconstruction without entropy and with it."""
        columns = {
            f"{look_of(model).label}, {kind}": (model, kind)
            for model in self._models
            for kind in ("without entropy", "with entropy")
        }
        return grid_table(
            heading(RECONSTRUCTION),
            {look_of(task).label: task for task in tasks},
            columns,
            lambda task, column: self._figure(task, *column, RECONSTRUCTION),
        )

    def _figure(self, task: str, model: str, condition: str, measure: str) -> str:
        one = self._found.get((task, model, condition, measure))
        return ABSENT if one is None else format_figure(one.interval.mean, one.interval.half_width)
