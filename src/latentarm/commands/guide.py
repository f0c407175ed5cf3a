"""`latentarm guide`: pages and files about arms, also where only the package is installed."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Final

from tyro.conf import Positional, arg

import latentarm
from latentarm.commands.output import say
from latentarm.core.errors import UserError

_PACKAGE: Final = Path(latentarm.__file__).parent
_PLACES: Final = (
    "docs/your-arm.md",
    "docs/arms.md",
    "docs/objects.md",
    "docs/deploy.md",
    "docs/your-arm",
    "deploy",
)
"""In the clone, and under ``guides`` in the wheel (`pyproject.toml`)."""


def guide_files() -> Iterator[Path]:
    """The pages and files, in the clone or, where only the package is installed, in it."""
    packed = _PACKAGE / "guides"
    root = packed if packed.is_dir() else _PACKAGE.parents[1]
    for place in (root / one for one in _PLACES):
        yield from sorted(one for one in place.iterdir() if one.is_file()) if place.is_dir() else (place,)


def guide(
    name: Annotated[
        Positional[str | None], arg(metavar="NAME", help="A page or a file; none lists them.")
    ] = None,
) -> int:
    """Print a page about arms, or a file that it names, such as the watchdog or an example of zones.

    For example: latentarm guide zones.toml > zones.toml
    """
    found = {path.name.removesuffix(".md"): path for path in guide_files()}
    if name is None:
        for one in found:
            say(one, json=False)
        return 0
    if name not in found:
        raise UserError(f"There is no {name}: name one of {', '.join(found)}.")
    sys.stdout.write(found[name].read_text(encoding="utf-8"))
    return 0
