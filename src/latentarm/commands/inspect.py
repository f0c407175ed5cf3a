"""`latentarm inspect`: the content of a dataset."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Final

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text
from tyro.conf import Positional, arg

from latentarm.commands.configuration import write_options
from latentarm.commands.output import note, say, show
from latentarm.core.errors import UserError
from latentarm.core.types import Demonstrations, Provenance
from latentarm.core.untrusted.terminal import visible
from latentarm.demonstrations.summary import Summary, summarise
from latentarm.runs.options import Json

_FINGERPRINT_LENGTH: Final = 64  # digits of a SHA-256


def _tables(demonstrations: Demonstrations, summary: Summary) -> list[Table]:
    """Episodes and joints as tables for the terminal."""
    tables: list[Table] = []
    for plain in summary.tables:
        table = Table(title=plain.title, title_justify="left", box=SIMPLE_HEAD, padding=0)
        for index, heading in enumerate(plain.headings()):
            # One word a line: the table then fits 80 columns.
            heading = heading.replace(" ", "\n")
            table.add_column(heading, justify="left" if index == 0 else "right", no_wrap=True)
        for line in plain.lines():
            table.add_row(*(Text(visible(text)) for text in line))
        tables.append(table)
    return [*_origin_tables(demonstrations), *tables]


def import_table(record: Mapping[str, str]) -> Table:
    """The decisions of an import, subject by subject."""
    table = Table(title="Import", title_justify="left", box=SIMPLE_HEAD, padding=0, show_header=False)
    for subject, decision in record.items():
        table.add_row(Text(visible(subject)), Text(visible(decision)))
    return table


def _origin_tables(demonstrations: Demonstrations) -> list[Table]:
    """The recorded origin of a dataset."""
    tables: list[Table] = []
    if demonstrations.import_record:
        tables.append(import_table(demonstrations.import_record))
    recorded = [episode.provenance for episode in demonstrations.episodes]
    # A column in which nothing is told would take the others' room.
    names = [
        field.name
        for field in fields(Provenance)
        if any(one is not None and getattr(one, field.name) != field.default for one in recorded)
    ]
    if names:
        table = Table("episode", title="Recorded", title_justify="left", box=SIMPLE_HEAD, padding=0)
        for name in names:
            table.add_column(name.replace("_", "\n"))
        for index, one in enumerate(recorded):
            told = ["" if one is None else getattr(one, name) for name in names]
            table.add_row(str(index), *(Text(_told(value)) for value in told))
        tables.append(table)
    return tables


def _told(value: object) -> str:
    """A value of a `Provenance` for a table; fingerprints are abbreviated."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    text = visible(str(value)) or "–"
    return text if len(text) < _FINGERPRINT_LENGTH else f"{text[:8]}…"


def inspect(
    dataset: Annotated[Positional[Path], arg(metavar="DST", help="Folder of a native dataset.")],
    out: Annotated[
        Path | None, arg(metavar="DIR", help="Folder for the figure; next to the dataset by default.")
    ] = None,
    json: Json = False,
) -> int:
    """Show a dataset: episodes, rates, ranges, and a figure of the joints.

    For example: latentarm inspect pour
    """
    from latentarm.demonstrations.dataset import read_dataset
    from latentarm.demonstrations.figure import draw_trajectories
    from latentarm.robots.catalogue import load_recorded_robot

    demonstrations = read_dataset(dataset)
    robot = None
    try:
        robot = load_recorded_robot(demonstrations, str(dataset)) if demonstrations.robot else None
    except UserError as error:
        note([f"Limits and the tool's path are not known. {error}"])
    note(demonstrations.warnings)
    figure = (out or dataset.with_name(f"{dataset.name}-figures")) / "joints.png"
    draw_trajectories(demonstrations, figure, robot.limits if robot else None)
    write_options(figure.parent, "inspect")
    summary = summarise(demonstrations, robot)
    show(summary.rows(), json, *_tables(demonstrations, summary))
    say(f"The joints over time are drawn in {figure}.", json)
    return 0
