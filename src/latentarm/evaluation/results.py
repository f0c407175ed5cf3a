"""The JSON document of a command's figures."""

from collections.abc import Iterable, Mapping

from latentarm.core.types import Row


def as_document(rows: Iterable[Row], about: Mapping[str, object] | None = None) -> dict[str, object]:
    """The one JSON document of a command: its rows, and what they are about (settings, versions)."""
    return {"about": dict(about or {}), "rows": [row.as_json() for row in rows]}
