"""Which code a result was computed with."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import latentarm

_PACKAGES: Final = (Path(latentarm.__file__).parent, Path(__file__).parents[1])

_REPORTS: Final = ("studies", "user_studies", "web", "commands", "testing", "cli.py")
"""Parts of the packages that no part below them computes with."""


def source_digest(modules: Sequence[Path]) -> str:
    """The first 16 digits of the SHA-256 of the code below the studies, and of some modules more."""
    digest = hashlib.sha256()
    below = {
        path
        for package in _PACKAGES
        for path in package.rglob("*")
        if path.suffix in (".py", ".json") and path.relative_to(package).parts[0] not in _REPORTS
    }
    for path in sorted({*below, *modules}, key=_named):
        digest.update(f"{_named(path)}\n".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _named(path: Path) -> str:
    """A file's place, the same on every computer."""
    package = next(package for package in _PACKAGES if path.is_relative_to(package))
    return f"{package.name}/{path.relative_to(package).as_posix()}"
