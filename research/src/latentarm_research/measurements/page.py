"""The page of a measurement: its tables in Markdown, and the command, commit and date under them."""

from collections.abc import Sequence
from dataclasses import fields
from datetime import UTC, datetime
from typing import Any

from latentarm.core.types import Row
from latentarm.evaluation.table import format_figure
from latentarm.runs.folder import git_commit
from latentarm_research.measurements.measurement import UNITS, Outcome, unit_of
from latentarm_research.studies.tables import markdown_table


def page_of(title: str, outcome: Outcome, command: str) -> str:
    """The page in Markdown."""
    commit = (git_commit() or "unknown")[:8]
    parts = [f"# {title}", outcome.note]
    for task in dict.fromkeys(row.task for row in outcome.rows):
        rows = [row for row in outcome.rows if row.task == task]
        parts += [f"## {task}" if task else "", table_of(rows)]
    parts += ["\n".join(f"- **Limit broken**: {sentence}" for sentence in outcome.broken)]
    parts += [f"`{command}`, commit {commit}, {datetime.now(UTC):%Y-%m-%d}."]
    return "\n\n".join(part.rstrip("\n") for part in parts if part) + "\n"


def table_of(rows: Sequence[Row]) -> str:
    """Conditions down, measures across."""
    measures = list(dict.fromkeys(row.measure for row in rows))
    lines: dict[str, dict[str, str]] = {}
    for row in rows:
        lines.setdefault(row.condition or "all", {"n": f"{row.n:,}"})[row.measure] = _figure(row)
    head = ["", "n", *map(_head, measures)]
    return markdown_table(
        head, ([name, *(cells.get(one) for one in ("n", *measures))] for name, cells in lines.items())
    )


def repeated_by(name: str, options: Any, seed: int) -> str:
    """The command that repeats a measurement, with the options that are not as usual."""
    words = [f"latentarm measure {name}"]
    for one in fields(options):
        value = getattr(options, one.name)
        if value == one.default:
            continue
        values = value if isinstance(value, tuple) else (value,)
        words += [f"--{one.name.replace('_', '-')}", *(str(each) for each in values if each is not True)]
    return " ".join([*words, "--seed", str(seed)])


def _head(measure: str) -> str:
    ending = next((one for one in UNITS if measure.endswith(one)), "")
    unit = f" ({unit_of(measure)})" if ending else ""
    return measure.removesuffix(ending).replace("_", " ") + unit


def _figure(row: Row) -> str:
    if row.mean is None or row.sd is not None:
        return format_figure(row.mean, row.sd)
    return f"{row.mean:,.0f}" if row.mean == round(row.mean) else f"{row.mean:.4g}"
