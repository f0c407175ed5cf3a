"""Sheets of a questionnaire: CSV to fill in at a screen, Markdown to print."""

import csv
from collections.abc import Sequence
from io import StringIO
from itertools import groupby
from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm_research.studies.tables import markdown_table
from latentarm_research.user_studies.answers.items import Asked
from latentarm_research.user_studies.definition import Definition

COLUMNS: Final = ("person", "condition", "item", "text", "answer")
"""Of a CSV sheet; the last one is empty until people answer."""


def write_sheet(
    path: Path,  # ends in `.csv` or `.md`
    definition: Definition,
    asked: Sequence[Asked],
) -> None:
    """Write a sheet.

    Raises:
        UserError: the file has another ending, exists, or cannot be written.
    """
    kinds = {".csv": _csv, ".md": _markdown}
    if path.suffix not in kinds:
        raise UserError(f"{path} must end in {' or '.join(kinds)}.")
    if path.exists():
        raise UserError(f"{path} already exists, and may hold answers: name another file with --out.")
    write_text(path, kinds[path.suffix](definition, asked))


def _csv(definition: Definition, asked: Sequence[Asked]) -> str:
    stream = StringIO()
    lines = csv.writer(stream, lineterminator="\n")
    lines.writerow(COLUMNS)
    lines.writerows((one.person, one.condition, one.item, one.text, "") for one in asked)
    return stream.getvalue()


def _markdown(definition: Definition, asked: Sequence[Asked]) -> str:
    points = definition.questionnaire[0].points
    scale = [str(point) for point in range(1, points + 1)]
    parts = [f"# {definition.title}\n"]
    for (person, condition), lines in groupby(asked, lambda one: (one.person, one.condition)):
        parts.append(f"## Person {person}, after {condition}\n")
        parts.append(f"1: I strongly disagree. {points}: I strongly agree. Mark one number on each line.\n")
        parts.append(
            markdown_table(
                ["statement", *scale, "item"], [[one.text, *("☐" for _ in scale), one.item] for one in lines]
            )
        )
    return "\n".join(parts)
