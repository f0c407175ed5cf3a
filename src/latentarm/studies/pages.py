"""Parts of a study's ``results.md``."""

from collections.abc import Iterable, Sequence
from pathlib import Path


def markdown_table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """A GitHub table, ending in a line break; all columns but the first to the right."""
    rule = ["---", *("---:" for _ in head[1:])]
    return "".join("| " + " | ".join(line) + " |\n" for line in (head, rule, *lines))


def shown(names: Iterable[str]) -> list[str]:
    """PNGs of the page's own folder as Markdown."""
    return [f"![{Path(name).stem.replace('_', ' ')}, simulated]({name})\n" for name in names]


def listed(names: Iterable[str]) -> str:
    """``A, B and C``, each once."""
    *most, last = dict.fromkeys(names)
    return f"{', '.join(most)} and {last}" if most else last
