"""The runs that can be driven, by the names that pages call them."""

from pathlib import Path
from typing import final


@final
class RunList:
    """Runs that were trained on the page, and the one that the server was started with.

    Pages name a run by its name here, never by a path.

    Args:
        out: folder that holds ``runs``.
        first: the run that the server was started with, or None.
    """

    def __init__(self, out: Path, first: Path | None) -> None:
        self._out = out
        self._first = first

    def runs(self) -> dict[str, Path]:
        """Folders by name, in the order of the names; whole runs alone."""
        found = {path.parent.name: path.parent for path in self._out.glob("runs/*/config.json")}
        if self._first is not None:
            name = self._first.resolve().name
            if name in found and not _same(found[name], self._first):
                name += " (as started)"
            found[name] = self._first
        return dict(sorted(found.items()))

    def name_of(self, run: Path | None) -> str | None:
        """What pages call a run; None for None."""
        if run is None:
            return None
        return next((name for name, path in self.runs().items() if _same(path, run)), run.resolve().name)


def _same(one: Path, other: Path) -> bool:
    return one.resolve() == other.resolve()
