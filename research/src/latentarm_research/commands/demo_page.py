"""Parts of the page that `latentarm demo` writes: pictures of one drive, and the README's table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from latentarm.core.errors import UserError
from latentarm.core.figure_style import save_figure
from latentarm.core.types import Row
from latentarm.evaluation.looks import look_of
from latentarm.evaluation.table import format_figure, measure_name, series_name
from latentarm_research.drives.drives import Planned
from latentarm_research.drives.film import Camera, Film, strip
from latentarm_research.drives.trace import Trace
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
