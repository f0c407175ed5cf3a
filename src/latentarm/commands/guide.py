"""`latentarm guide`: pages and files about arms, also where only the package is installed."""

import json as json_format
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Final

from tyro.conf import Positional, arg

import latentarm
from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import read_bytes
from latentarm.runs.options import Json

_MOST_BYTES: Final = 1 << 20
_PACKAGE: Final = Path(latentarm.__file__).parent
_INCLUDED: Final = re.compile(r'--8<-- ".*/(.+)"')  # where a page shows a file
_PLACES: Final = (
    "docs/your-arm.md",
    "docs/arms.md",
    "docs/objects.md",
    "docs/deploy.md",
    "docs/your-arm",
    "examples/your_own_detector.py",
    "deploy",
)
"""In the clone, and under ``guides`` in the wheel (`pyproject.toml`)."""


def guide_files() -> Iterator[Path]:
    """The pages and files, in the clone or, where only the package is installed, in it."""
    packed = _PACKAGE / "guides"
    root = packed if packed.is_dir() else _PACKAGE.parents[1]
    for place in (root / one for one in _PLACES):
        yield from sorted(one for one in place.iterdir() if one.is_file()) if place.is_dir() else (place,)


def _read(path: Path) -> str:
    return read_bytes(path, _MOST_BYTES).decode()


def guide(
    name: Annotated[
        Positional[str | None], arg(metavar="NAME", help="A page or a file; none lists them.")
    ] = None,
    json: Json = False,
) -> int:
    """Print a page about arms, or a file that it names.

    Such files are the watchdog of ROS 2, examples of zones and limits, and the unit of systemd. For example:
    latentarm guide zones.toml > zones.toml
    """
    found = {path.name.removesuffix(".md"): path for path in guide_files()}
    if name is not None and name not in found:
        raise UserError(f"There is no {name}: name one of {', '.join(found)}.")
    text = "\n".join((*found, "")) if name is None else _read(found[name])
    text = _INCLUDED.sub(lambda line: _read(found[line[1]]).rstrip(), text)
    if json:
        text = json_format.dumps({"names": list(found)} if name is None else {name: text}) + "\n"
    sys.stdout.write(text)
    return 0
