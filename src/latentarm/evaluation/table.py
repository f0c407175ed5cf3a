"""Rows as a table for the terminal and as a table for GitHub."""

import math
from collections.abc import Mapping, Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table

from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.measures import label_of

BORDER = 3  # characters between two columns
ABSENT = "–"
ROUNDING = 1e-12  # smaller figures are the rounding of a zero


def format_figure(mean: float | None, sd: float | None) -> str:
    """Mean ± SD, both to the place of the SD's second digit and the mean to at most four digits."""
    if mean is None:
        return ABSENT
    if abs(mean) < ROUNDING and (sd or 0.0) < ROUNDING:
        return "0"
    if not sd or sd < 1e-9 * abs(mean):  # the rounding of figures that are all the same
        return _rounded(mean, _places(mean, 3))
    places = min(_places(sd, 2), _places(mean, 4)) if mean else _places(sd, 2)
    return f"{_rounded(mean, places)} ± {_rounded(sd, places)}"


def _places(value: float, digits: int) -> int:
    """Decimal places that show ``value`` to this many digits."""
    return digits - 1 - math.floor(math.log10(abs(value))) if value else 0


def _rounded(value: float, places: int) -> str:
    """The value to this many decimal places; far from one, in powers of ten."""
    if places > 6 or places < -6:
        return f"{value:.2g}"
    return f"{round(value, places):.{max(places, 0)}f}"


def series_name(row: Row) -> str:
    """A table's heading for a row's model and condition."""
    # Conditions have parts, such as "end_effector, learning".
    names = [name for name in (row.model, *(row.condition or "").split(", ")) if name]
    parts = [look_of(name).label for name in names]
    return ", ".join(parts) or row.study


def measure_name(row: Row) -> str:
    """A measure's name and unit as people read them."""
    name = label_of(row.measure)
    return name if row.unit in ("", "1") else f"{name} ({row.unit})"


def rich_tables(rows: Sequence[Row], title: str = "", width: int = 100) -> RenderableType:
    """Measures down, models or conditions across; with several tasks, the head names them."""
    return rich_figures(*_arranged(rows), title=title, width=width)


def rich_figures(
    measures: Sequence[str],
    series: Sequence[str],
    figures: Mapping[tuple[str, str], str],
    *,
    corner: str = "mean ± SD",
    title: str = "",
    width: int = 100,
) -> RenderableType:
    """A terminal's table of figures by measure, down, and series, across.

    If the columns are too wide, the SD goes below the mean; if that is not enough, the table is split.
    """
    room = width - max((len(measure) for measure in (*measures, corner)), default=0) - BORDER - 1
    widths = _column_widths(measures, series, figures)
    stacked = {place: figure.replace(" ± ", "\n± ") for place, figure in figures.items()}
    stacked_widths = _column_widths(measures, series, stacked)
    if sum(stacked_widths) <= room < sum(widths):
        figures, widths = stacked, stacked_widths
    tables: list[RenderableType] = []
    for part in _fitting(widths, room):
        table = Table(title=None if tables else title, title_justify="left", box=SIMPLE_HEAD)
        table.add_column(corner, no_wrap=True)
        for index in part:
            table.add_column(series[index], justify="right", min_width=widths[index] - BORDER)
        for measure in measures:
            table.add_row(measure, *(figures.get((measure, series[index]), ABSENT) for index in part))
        tables.append(table)
    return Group(*tables)


def _column_widths(
    measures: Sequence[str], series: Sequence[str], figures: Mapping[tuple[str, str], str]
) -> list[int]:
    """The minimum width of each series: a heading may wrap, a number may not."""
    widths: list[int] = []
    for name in series:
        lines = [line for measure in measures for line in figures.get((measure, name), ABSENT).split("\n")]
        widths.append(max(map(len, [*name.split(), *lines])) + BORDER)
    return widths


def _fitting(widths: Sequence[int], room: int) -> list[list[int]]:
    """Indices of columns in order, broken into as few tables as the room across allows."""
    parts: list[list[int]] = []
    left = 0
    for index, wide in enumerate(widths):
        if wide > left or not parts:
            parts.append([])
            left = room
        parts[-1].append(index)
        left -= wide
    return parts


def markdown_table(rows: Sequence[Row]) -> str:
    """The same arrangement as a GitHub table, ending in a line break."""
    measures, series, figures = _arranged(rows)
    lines = [
        "| mean ± SD |" + "".join(f" {_cell(name)} |" for name in series),
        "|---|" + "---:|" * len(series),
    ]
    lines += [
        f"| {_cell(measure)} | " + " | ".join(figures.get((measure, name), ABSENT) for name in series) + " |"
        for measure in measures
    ]
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    """Text that cannot end its cell."""
    return text.replace("|", "\\|").replace("\n", " ")


def _arranged(rows: Sequence[Row]) -> tuple[list[str], list[str], dict[tuple[str, str], str]]:
    """Measures and series in order of first appearance, and the figure for each pair."""
    many_tasks = len({row.task for row in rows}) > 1

    def place(row: Row) -> tuple[str, str]:
        name = series_name(row)
        return measure_name(row), f"{row.task}: {name}" if many_tasks and row.task else name

    measures = list(dict.fromkeys(place(row)[0] for row in rows))
    series = list(dict.fromkeys(place(row)[1] for row in rows))
    return measures, series, {place(row): format_figure(row.mean, row.sd) for row in rows}
