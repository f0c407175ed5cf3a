"""What `latentarm demo` writes for a reader: a page, and a strip of pictures of one drive."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.core.figure_style import save_figure
from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import format_figure, markdown_table, measure_name, series_name
from latentarm.tasks.scene_task import SceneTask
from latentarm_research.drives.drives import Planned
from latentarm_research.drives.film import Camera, Film, strip
from latentarm_research.drives.trace import Trace
from latentarm_research.metrics.ending import STUCK_S
from latentarm_research.people.names import OperatorName
from latentarm_research.studies.tables import grid_table

FILM: Final = "film.png"

CAMERA: Final = Camera(look_at=(0.5, 0.0, 0.12), distance_m=0.48)  # near enough to see what is on the fork


@final
@dataclass(frozen=True)
class Filmed:
    """A strip of pictures, or why it is missing."""

    picture: str  # for the page, in Markdown; "" without one
    said: str  # what it shows, or why there is no strip, in a sentence


def film(out: Path, model: str, planned: Sequence[Planned], driven: Sequence[Trace]) -> Filmed:
    """Film the first drive that succeeded, where this machine renders."""
    first = next((index for index, trace in enumerate(driven) if trace.figures.success), None)
    if first is None:
        return Filmed("", f"No drive with the model {model} succeeded, so there is no {FILM}.")
    seen = Film()
    trace = planned[first].drive(seen.sees)
    try:
        times, pictures = seen.frames(CAMERA)
    except UserError as error:
        return Filmed("", f"{FILM} is left out. {error}")
    heading = f"Latent actions, {look_of(model).label}; person and arm simulated"
    save_figure(strip(heading, times, pictures, trace), out / FILM)
    return Filmed(
        f"![A drive in eight pictures: the fork goes over a marshmallow, into it, and lifts it]({FILM})\n\n",
        f"{FILM} shows one of these drives, with the marshmallow on the fork at its end.",
    )


def held_in_words(driven: Mapping[str, Sequence[Trace]]) -> str:
    """In how many drives of each condition the fork holds the food at the end."""
    counts = [
        f"{sum(trace.figures.success for trace in traces)} of {len(traces)} drives with {name}"
        for name, traces in driven.items()
    ]
    return f"The fork holds the marshmallow in {'; '.join(counts)}."


README: Final = ("success_rate", "time_s", "input_magnitude", "mode_switches")
"""Measures of the README's table."""


def readme_table(rows: Sequence[Row]) -> str:
    """The README's table of the drives of one person: what steers down, a few measures across."""
    shown = [row for row in rows if row.measure in README]
    figures = {(series_name(row), row.measure): format_figure(row.mean, row.sd) for row in shown}
    series = {series_name(row): series_name(row) for row in shown}
    measures = {measure_name(row): row.measure for row in shown}
    return grid_table("mean ± SD", series, measures, lambda line, column: figures[line, column])


def page(
    task: SceneTask,
    tables: Mapping[OperatorName, Sequence[Row]],
    properties: Sequence[Row],
    held: str,  # see `held_in_words`
    filmed: Filmed,  # see `film`
    *,
    model: str,
    shown: OperatorName,
    drives: int,
    others: int,
    seeds: int,
    seed: int,
) -> str:
    """The page of a demo, in Markdown."""
    choices = len(task.choices)
    return (
        "# What the demo measured\n\n"
        f"In physics, simulated operators drove a simulated Panda with a fork: the {shown} one"
        f" {drives * choices} times per column ({drives} times for each of {choices} marshmallows), the"
        f" others {others * choices} times. The {seeds} trained models of a kind take turns. Seed {seed};"
        f" mean ± SD over the drives, failed ones included (they end after {task.time_limit_s:g} s, or once"
        f" the tool has come no nearer for {STUCK_S:g} s). No person took part. {held}\n\n"
        f"{filmed.picture}"
        f"{readme_table(tables[shown])}\n"
        f"{_people_tables(tables)}"
        f"The figures show the model {model}, driven by the {shown} operator. Marks are over the"
        " marshmallows, which lie elsewhere in each drive.\n\n"
        "![Paths of the tool](paths.png)\n\n"
        "![Inputs over time](inputs.png)\n\n"
        "## The latent spaces, on held-out episodes\n\n"
        f"Mean ± SD over {seeds} seeds.\n\n{markdown_table(properties)}\n"
        "![The task, with the marshmallows where they lie in one run](task.png)\n"
    )


def _people_tables(tables: Mapping[OperatorName, Sequence[Row]]) -> str:
    """A table of drives under the name of each simulated person."""
    return "".join(f"## The {person} operator\n\n{markdown_table(rows)}\n" for person, rows in tables.items())
