"""Tables that people write by hand: errors name the file and the key."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, cast

from latentarm.core.errors import UserError

MOST_BYTES: Final = 100_000  # of a file; an entry takes some 200


def parse_toml(content: bytes, path: Path, kind: str) -> object:
    """The document in a TOML file's content; ``kind`` names the file in errors, such as ``limits file``."""
    try:
        return tomllib.loads(content.decode("utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
        what = "nested too deeply" if isinstance(error, RecursionError) else " ".join(str(error).split())
        raise UserError(f"The {kind} {path} cannot be read as TOML: {what}.") from error


def table_of(value: object, where: str, key: str) -> Mapping[str, Any]:
    """The value as a table with names as keys; ``key`` is "" for the outermost level."""
    if not isinstance(value, dict) or not all(isinstance(name, str) for name in cast(dict[Any, Any], value)):
        raise UserError(f"{where}: {key or 'the outermost level'} must be a table of names.")
    return cast(Mapping[str, Any], value)


def check_keys(given: Mapping[str, Any], known: Sequence[str], where: str, prefix: str) -> None:
    """Refuse unknown keys; ``prefix`` ends in a dot, or is "" on the outermost level."""
    for name in given:
        if name not in known:
            raise UserError(f"{where}: there is no key {prefix}{name}; use {', '.join(known)}.")


def number_of(value: object, where: str, key: str) -> float:
    """The value as a finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e9:
        raise UserError(f"{where}: {key} must be a finite number, not {str(value)[:40]!r}.")
    return float(value)
