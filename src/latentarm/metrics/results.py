"""Files of figures (``metrics.json``, ``results.json``): written whole or not at all, read with care."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, cast

from latentarm.errors import UserError
from latentarm.files import write_text
from latentarm.types import Row
from latentarm.untrusted.documents import read_object

TEXT_FIELDS = ("study", "measure", "unit", "task", "model", "condition")
NUMBER_FIELDS = ("mean", "sd", "paper_mean", "paper_sd")
OPTIONAL = {field.name for field in fields(Row) if field.default is not MISSING} | {"mean", "sd"}


def as_document(rows: Iterable[Row], about: Mapping[str, object] | None = None) -> dict[str, object]:
    """The one JSON document of a command: its rows, and what they are about (settings, versions)."""
    return {"about": dict(about or {}), "rows": [row.as_json() for row in rows]}


def write_results(path: Path, rows: Sequence[Row], about: Mapping[str, object] | None = None) -> None:
    """Write rows to a JSON file, whole or not at all.

    Args:
        path: the file, usually ``metrics.json`` or ``results.json``.
        rows: the figures; a figure that is not a number is None, never NaN.
        about: anything JSON can hold: settings, versions, the command.

    Raises:
        UserError: the file cannot be written.
        ValueError: a figure is NaN or infinite, which JSON does not have.
    """
    write_text(path, json.dumps(as_document(rows, about), indent=2, allow_nan=False) + "\n")


def read_results(path: Path) -> list[Row]:
    """Read what `write_results` wrote.

    Raises:
        UserError: the file is missing, is no JSON, or holds anything but rows.
    """
    rows = read_object(path).get("rows")
    if not isinstance(rows, list):
        raise UserError(f"{path} is not a file of results: it has no list called 'rows'.")
    return [_row(path, index, entry) for index, entry in enumerate(cast(list[object], rows))]


def _row(path: Path, index: int, entry: object) -> Row:
    """One checked row.

    Raises:
        UserError: the entry is no row.
    """
    if not isinstance(entry, dict):
        raise UserError(f"{path}, row {index}: not an object with named fields.")
    given = cast(dict[str, Any], entry)
    names = {field.name for field in fields(Row)}
    for name in sorted(given.keys() - names):
        raise UserError(f"{path}, row {index}: the field {name!r} is not known.")
    for name in sorted(names - OPTIONAL - given.keys()):
        raise UserError(f"{path}, row {index}: the field {name!r} is missing.")
    values: dict[str, Any] = {name: given.get(name) for name in names}
    for name, value in values.items():
        absent = value is None and name in OPTIONAL
        if name in TEXT_FIELDS and not (absent or isinstance(value, str)):
            raise UserError(f"{path}, row {index}: the field {name!r} must be text.")
        if name in NUMBER_FIELDS and not (absent or _is_number(value)):
            raise UserError(f"{path}, row {index}: the field {name!r} must be a finite number.")
    if not isinstance(values["n"], int) or isinstance(values["n"], bool) or values["n"] < 0:
        raise UserError(f"{path}, row {index}: the field 'n' must be a count.")
    return Row(**values)


def _is_number(value: object) -> bool:
    """Whether a JSON value is a finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) < float("inf")
