"""Writes the tables of docs/studies.md: the paper's statistics, and those of simulated people.

``python scripts/study_statistics.py studies/*`` takes the folders of runs of `latentarm study run`. Studies
without a folder stay marked as not run.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from latentarm.core.files import write_text
from latentarm.core.untrusted.documents import read_object
from latentarm.evaluation.table import ABSENT
from latentarm.runs.results_folder import CONFIG
from latentarm_research.studies.page import listed, markdown_table
from latentarm_research.user_studies.catalogue import NAMES, load_definition
from latentarm_research.user_studies.definition import Definition
from latentarm_research.user_studies.report.words import yes_no

PAGE = Path(__file__).parents[1] / "docs" / "studies.md"
NOT_RUN = "not run yet"
HEAD = (
    "section",
    "measure",
    "comparison",
    "the paper (real people)",
    "simulated people",
    "same sign",
    "same significance",
)


def main(folders: Sequence[str]) -> None:
    """Replace the table between the marks of the page."""
    found = {str(read_object(Path(folder) / CONFIG).get("study")): Path(folder) for folder in folders}
    lines = [
        line for name in NAMES for line in lines_of(load_definition(name), found.get(f"user study {name}"))
    ]
    runs = [
        about(load_definition(name), found[f"user study {name}"])
        for name in NAMES
        if f"user study {name}" in found
    ]
    said = "\n".join(runs) or "None of the studies was run for this table yet."
    text = PAGE.read_text(encoding="utf-8")
    text = replaced(text, "statistics", f"{said}\n\n{markdown_table(HEAD, lines)}")
    write_text(PAGE, replaced(text, "departures", departures()))


def replaced(text: str, mark: str, body: str) -> str:
    """A page with other text between two marks."""
    begin, end = f"<!-- {mark} -->", f"<!-- end of {mark} -->"
    before, after = text.partition(begin)[0], text.partition(end)[2]
    return f"{before}{begin}\n\n{body}\n{end}{after}"


def departures() -> str:
    """Where each definition differs from what the paper did."""
    return "\n".join(f"- `{name}`: {' '.join(load_definition(name).departures)}" for name in NAMES)


def about(definition: Definition, folder: Path) -> str:
    """Of how many people, and with which sizes and seed, in a line."""
    config = read_object(folder / CONFIG)
    sizes: Any = config["preset"]
    return (
        f"- `{definition.name}`: {config['simulated']} simulated people, preset {sizes['name']}, seed"
        f" {config['seed']},"
        f" definition {str(config['definition'])[:12]}."
    )


def lines_of(definition: Definition, folder: Path | None) -> list[list[str]]:
    """A line for each statistic of a study."""
    ours: list[Any] = []
    if folder is not None:
        ours = read_object(folder / "analysis.json")["as_printed"]
    labels = {task.name: task.label for task in definition.tasks}
    lines: list[list[str]] = []
    for index, printed in enumerate(definition.printed):
        where = f" ({listed(labels[task] for task in printed.tasks)})" if printed.tasks else ""
        sides = " against ".join(listed(side) for side in (printed.subject, printed.against) if side)
        said = (
            [ours[index][key] for key in ("ours", "same_sign", "same_significance")]
            if ours
            else [NOT_RUN, None, None]
        )
        cells = [said[0], *(ABSENT if one is None else yes_no(one) for one in said[1:])]
        lines.append(
            [definition.section, definition.label(printed.measure) + where, sides, printed.text, *cells]
        )
    return lines


if __name__ == "__main__":
    main(sys.argv[1:])
