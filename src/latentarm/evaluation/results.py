"""Files of figures (``metrics.json``, ``results.json``), written whole or not at all."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from latentarm.core.files import write_text
from latentarm.core.types import Row


def as_document(rows: Iterable[Row], about: Mapping[str, object] | None = None) -> dict[str, object]:
    """The one JSON document of a command: its rows, and what they are about (settings, versions)."""
    return {"about": dict(about or {}), "rows": [row.as_json() for row in rows]}


def write_results(path: Path, rows: Sequence[Row], about: Mapping[str, object] | None = None) -> None:
    """Write rows to a JSON file (``metrics.json``, ``results.json``), whole or not at all.

    Raises:
        UserError: the file cannot be written.
        ValueError: a figure is NaN or infinite; an absent figure is None.
    """
    write_text(path, json.dumps(as_document(rows, about), indent=2, allow_nan=False) + "\n")
