"""`latentarm inspect`: a dataset looked over before training on it."""

from pathlib import Path
from typing import TYPE_CHECKING

from latentarm.demonstrations.summary import Summary, summarise
from latentarm.errors import UserError
from latentarm.robots.catalogue import load_robot
from latentarm.robots.robot import Robot
from latentarm.types import Demonstrations

if TYPE_CHECKING:
    from rich.table import Table


def known_robot(demonstrations: Demonstrations) -> Robot | None:
    """The robot that a dataset names, or None where it names none or that one is not to be had here."""
    try:
        return load_robot(demonstrations.robot) if demonstrations.robot else None
    except UserError:
        return None


def summary(demonstrations: Demonstrations) -> Summary:
    """The dataset in figures, with the limits of its robot where that is known."""
    return summarise(demonstrations, known_robot(demonstrations))


def summary_tables(demonstrations: Demonstrations) -> "list[Table]":
    """Episodes and joints as tables for the terminal."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    tables: list[Table] = []
    for plain in summary(demonstrations).tables():
        table = Table(title=plain.title, title_justify="left", box=SIMPLE_HEAD, padding=0)
        for index, heading in enumerate(plain.columns):
            # One word a line: the table then fits 80 columns.
            heading = heading.replace(" ", "\n")
            table.add_column(heading, justify="left" if index == 0 else "right", no_wrap=True)
        for row in plain.rows:
            table.add_row(*row)
        tables.append(table)
    return tables


def draw(demonstrations: Demonstrations, folder: Path) -> Path:
    """Draw the joints over time.

    Returns:
        The figure's path.

    Raises:
        UserError: the folder cannot be written.
    """
    from latentarm.demonstrations.figure import draw_trajectories

    robot = known_robot(demonstrations)
    path = folder / "joints.png"
    draw_trajectories(demonstrations, path, robot.limits if robot else None)
    return path
