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
from latentarm.robots.robot import Robot
from latentarm.runs.options import Json

_FINGERPRINT_LENGTH: Final = 64  # digits of a SHA-256


def known_robot(demonstrations: Demonstrations) -> Robot | None:
    """The robot that a dataset names, or None if it names none or that robot is not available."""
    from latentarm.robots.catalogue import load_recorded_robot

    try:
        return load_recorded_robot(demonstrations) if demonstrations.robot else None
    except UserError:
        return None


def why_unknown(demonstrations: Demonstrations, dataset: str) -> str | None:
    """Why the robot that a dataset names cannot be loaded; None if it can, or if none is named."""
    from latentarm.robots.catalogue import load_recorded_robot

    try:
        if demonstrations.robot:
            load_recorded_robot(demonstrations, dataset)
    except UserError as error:
        return f"Limits and the tool's path are not known. {error}"
    return None


def summary(demonstrations: Demonstrations) -> Summary:
    """The dataset in figures, with the limits of its robot where that is known."""
    return summarise(demonstrations, known_robot(demonstrations))


def summary_tables(demonstrations: Demonstrations) -> list[Table]:
    """Episodes and joints as tables for the terminal."""
    tables: list[Table] = []
    for plain in summary(demonstrations).tables():
        table = Table(title=plain.title, title_justify="left", box=SIMPLE_HEAD, padding=0)
        for index, heading in enumerate(plain.columns):
            # One word a line: the table then fits 80 columns.
            heading = heading.replace(" ", "\n")
            table.add_column(heading, justify="left" if index == 0 else "right", no_wrap=True)
        for row in plain.rows:
            table.add_row(*(Text(visible(text)) for text in row))
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


def draw(demonstrations: Demonstrations, folder: Path) -> Path:
    """Draw the joints over time; the figure's path. UserError where the folder cannot be written."""
    from latentarm.demonstrations.figure import draw_trajectories

    robot = known_robot(demonstrations)
    path = folder / "joints.png"
    draw_trajectories(demonstrations, path, robot.limits if robot else None)
    return path


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

    demonstrations = read_dataset(dataset)
    unknown = why_unknown(demonstrations, str(dataset))
    if unknown:
        note([unknown])
    note(demonstrations.warnings)
    figure = draw(demonstrations, out or dataset.with_name(f"{dataset.name}-figures"))
    write_options(figure.parent, "inspect")
    show(summary(demonstrations).rows(), json, *summary_tables(demonstrations))
    say(f"The joints over time are drawn in {figure}.", json)
    return 0
