"""Figures of runs and tables of all studies, in Markdown for a page and for a terminal."""

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeVar, final

import numpy as np

from latentarm.core.types import FloatArray, Row
from latentarm.evaluation.measures import label_of, unit_of
from latentarm.evaluation.summary import Subject, summarise
from latentarm.evaluation.table import ABSENT, format_figure

if TYPE_CHECKING:
    from rich.table import Table

Line = TypeVar("Line")
Column = TypeVar("Column")


@final
class Series(NamedTuple):
    """One measure of one model under one condition."""

    task: str
    model: str
    condition: str | None  # None in the study's main setting
    measure: str
    values: FloatArray  # (n,), of each run

    def row(self, study: str) -> Row:
        """Mean and SD over the runs."""
        return summarise(Subject(study, self.task, self.model, self.condition), self.measure, self.values)

    def as_json(self) -> dict[str, object]:
        """Plain mapping; figures that are not finite are None."""
        values = [value if math.isfinite(value) else None for value in self.values.tolist()]
        return {**self._asdict(), "values": values}


def markdown_table(head: Sequence[str], lines: Iterable[Sequence[str | None]]) -> str:
    """A GitHub table; all columns but the first to the right, and a dash for what is None."""
    rule = ["---", *("---:" for _ in head[1:])]
    texts = [[ABSENT if text is None else text for text in line] for line in (head, rule, *lines)]
    return "\n".join("| " + " | ".join(line) + " |" for line in texts) + "\n"


def grid_table(
    corner: str,
    lines: Mapping[str, Line],
    columns: Mapping[str, Column],
    cell: Callable[[Line, Column], str | None],
) -> str:
    """A GitHub table of lines and columns by name; a dash where a cell is None."""
    texts = ([name, *(cell(line, column) for column in columns.values())] for name, line in lines.items())
    return markdown_table([corner, *columns], texts)


def terminal_table(title: str, head: Sequence[str], lines: Iterable[Sequence[str]]) -> "Table":
    """A table for a terminal; all columns but the first to the right."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(head[0], title=title, title_justify="left", box=SIMPLE_HEAD)
    for name in head[1:]:
        table.add_column(name, justify="right")
    for line in lines:
        table.add_row(*line)
    return table


def heading(measure: str, label: str = "") -> str:
    """What a table calls a measure, with its unit; by another label where one is given."""
    unit, name = unit_of(measure), label or label_of(measure)
    return name if unit == "1" else f"{name} ({unit})"


def mean_and_sd(values: FloatArray) -> str:
    """Mean ± SD of figures (n,), as tables show them; the mean alone of a single one."""
    return format_figure(float(values.mean()), float(np.std(values, ddof=1)) if len(values) > 1 else None)


def plain(text: str) -> str:
    """Text in one line that Markdown shows as it is: a stranger's, such as a name in a definition."""
    return re.sub(r"[\\`*_|\[\]]|<(?=[a-zA-Z/!?])|&(?=[a-zA-Z#])", r"\\\g<0>", " ".join(text.split()))


def plain_table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A GitHub table of cells that are shown as they are, all to the left."""
    texts = [[plain(text) for text in line] for line in (head, *lines)]
    texts.insert(1, ["---"] * len(head))
    return "\n".join("| " + " | ".join(line) + " |" for line in texts) + "\n"


def listed(names: Iterable[str]) -> str:
    """``A, B and C``, each once; empty for none."""
    each = list(dict.fromkeys(names))
    return " and ".join(filter(None, (", ".join(each[:-1]), *each[-1:])))
