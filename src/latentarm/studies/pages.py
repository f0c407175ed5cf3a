"""Figures on a page."""

from collections.abc import Iterable
from pathlib import Path


def shown(names: Iterable[str]) -> list[str]:
    """PNGs of the page's own folder as Markdown."""
    return [f"![{Path(name).stem.replace('_', ' ')}, simulated]({name})\n" for name in names]
