"""Results in a folder: those of another run are not replaced silently."""

import json
from collections.abc import Mapping
from itertools import count
from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError
from latentarm.core.files import write_text

SHORT: Final = 40  # characters of a value in a sentence, at most


def refuse_other_results(
    results: Path, out: Path, earlier: Mapping[str, object], wanted: Mapping[str, object]
) -> None:
    """Raise a UserError where earlier results depend on other options than the new ones would."""
    names = [name for name in dict.fromkeys((*wanted, *earlier)) if wanted.get(name) != earlier.get(name)]
    if names:
        shown = ", ".join(
            f"{name} {_short(earlier.get(name))} there, {_short(wanted.get(name))} now" for name in names[:2]
        )
        more = f" and {len(names) - 2} more differences" if len(names) > 2 else ""
        raise UserError(
            f"{results} holds the results of another run ({shown}{more}): choose another folder with --out,"
            f" such as {vacant_name(out)}."
        )


def vacant_name(out: Path) -> Path:
    """The folder's name with the first number that does not exist yet."""
    named = out if out.name else out.resolve()
    return next(place for one in count(2) if not (place := named.with_name(f"{named.name}-{one}")).exists())


def _short(value: object) -> str:
    said = json.dumps(value)
    return f"{said[:SHORT]}…" if len(said) > SHORT else said


def write_json(path: Path, document: object) -> None:
    """Write a document as JSON, whole or not at all.

    Raises UserError where the file cannot be written, and ValueError where a figure is NaN or infinite.
    """
    write_text(path, json.dumps(document, indent=2, allow_nan=False) + "\n")
