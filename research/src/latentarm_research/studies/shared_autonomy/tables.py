"""The study's tables: in Markdown for the page, and at a glance for a terminal."""

from collections.abc import Sequence
from typing import final

from rich.box import SIMPLE_HEAD
from rich.table import Table

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.measures import label_of, unit_of
from latentarm.evaluation.table import ABSENT, format_figure, measure_name
from latentarm_research.studies.shared_autonomy.ablations import variants
from latentarm_research.studies.shared_autonomy.cell import METHODS
from latentarm_research.studies.shared_autonomy.hypotheses import MEASURE
from latentarm_research.studies.shared_autonomy.preset import Preset
from latentarm_research.studies.shared_autonomy.rows import EXTRA_TIME, MODEL, PAPER, RECONSTRUCTION, Figure
from latentarm_research.studies.tables import markdown_table


@final
class Tables:
    """The tables of the page, in Markdown: means with their intervals."""

    def __init__(self, found: Sequence[Figure], preset: Preset) -> None:
        self._found = {(one.task, one.model, one.condition, one.measure): one for one in found}
        self._preset = preset
        self._people = [person.label for person in preset.people]
        self._models = list(dict.fromkeys(one.model for one in found))

    def people(self, task: str, model: str, measure: str) -> str:
        """One measure with one model: people down, methods across."""
        lines = [
            [person, *(self._figure(task, model, f"{method}, {person}", measure) for method in METHODS)]
            for person in self._people
        ]
        return markdown_table([_named(measure), *METHODS], lines)

    def extra_time(self, task: str) -> str:
        """How much more time LA takes than LA+SA, with the paper's figures."""
        head = [_named(EXTRA_TIME), *(look_of(model).label for model in self._models)]
        lines = [
            [person, *(self._extra_time(task, model, person) for model in self._models)]
            for person in self._people
        ]
        return markdown_table(head, lines)

    def reconstruction(self, tasks: Sequence[str]) -> str:
        """Reconstruction without entropy and with it."""
        columns = [(model, kind) for model in self._models for kind in ("without entropy", "with entropy")]
        lines = [
            [look_of(task).label, *(self._figure(task, *column, RECONSTRUCTION) for column in columns)]
            for task in tasks
        ]
        names = [f"{look_of(model).label}, {kind}" for model, kind in columns]
        return markdown_table([_named(RECONSTRUCTION), *names], lines)

    def ablation(self, task: str) -> str:
        """What is varied about the entropy: variants down, reconstruction and final errors across."""
        if self._preset.ablation is None:
            return ""
        people = [person.label for person in self._preset.varied_people]
        lines = [
            [
                name,
                self._figure(task, MODEL, name, RECONSTRUCTION),
                *(self._figure(task, MODEL, f"{name}, {person}", MEASURE) for person in people),
            ]
            for name in variants(self._preset.ablation, self._preset.entropy)
        ]
        return markdown_table(
            ["", _named(RECONSTRUCTION), *(f"{_named(MEASURE)}, {person}" for person in people)], lines
        )

    def _figure(self, task: str, model: str, condition: str, measure: str) -> str:
        one = self._found.get((task, model, condition, measure))
        return ABSENT if one is None else format_figure(one.interval.mean, one.interval.half_width)

    def _extra_time(self, task: str, model: str, person: str) -> str:
        printed = PAPER.get((task, model, EXTRA_TIME, person))
        beside = "" if printed is None else f" (paper: {printed:g})"
        return self._figure(task, model, person, EXTRA_TIME) + beside


def summary_tables(rows: Sequence[Row]) -> list[Table]:
    """One table per arm: the final state error with the paper's model, people down, methods across."""
    chosen = [row for row in rows if (row.measure, row.model) == (MEASURE, MODEL)]
    return [
        _summary([row for row in chosen if row.task == task])
        for task in dict.fromkeys(row.task for row in chosen)
    ]


def _summary(rows: Sequence[Row]) -> Table:
    found = {row.condition: format_figure(row.mean, row.sd) for row in rows}
    label = f"{look_of(rows[0].task or '').label}, {look_of(MODEL).label}, simulated: {measure_name(rows[0])}"
    table = Table("mean ± SD", title=label, title_justify="left", box=SIMPLE_HEAD)
    for method in METHODS:
        table.add_column(method, justify="right")
    parted = [(row.condition or "").partition(", ") for row in rows]
    for person in dict.fromkeys(person for method, _, person in parted if method in METHODS):
        table.add_row(person, *(found.get(f"{method}, {person}", ABSENT) for method in METHODS))
    return table


def _named(measure: str) -> str:
    """A measure and its unit as people read them."""
    unit = unit_of(measure)
    return label_of(measure) if unit == "1" else f"{label_of(measure)} ({unit})"
