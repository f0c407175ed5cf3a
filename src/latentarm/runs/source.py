"""Which code a result was computed with."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Final

_PACKAGE: Final = Path(__file__).parents[1]

_REPORTS: Final = ("studies", "user_studies", "web", "commands", "testing", "cli.py")
"""Parts of the package that no part below them computes with."""


def source_digest(modules: Sequence[Path]) -> str:
    """The first 16 digits of the SHA-256 of the code below the studies, and of some modules more.

    Args:
        modules: further files of the package.
    """
    digest = hashlib.sha256()
    below = (
        path
        for path in _PACKAGE.rglob("*")
        if path.suffix in (".py", ".json") and path.relative_to(_PACKAGE).parts[0] not in _REPORTS
    )
    for path in sorted({*below, *modules}):
        digest.update(f"{path.relative_to(_PACKAGE).as_posix()}\n".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
