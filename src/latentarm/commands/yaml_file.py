"""A flat YAML file of options, parsed as untrusted input."""

from pathlib import Path
from typing import Any, Final, cast

from latentarm.core.errors import UserError
from latentarm.core.untrusted.yaml_file import read_yaml

MOST_BYTES: Final = 1 << 16


def read_mapping(path: Path) -> dict[str, Any]:
    """The mapping from names to numbers, texts and lists of these in a YAML file; UserError for any other."""
    value = read_yaml(path, MOST_BYTES, "a YAML file of options")
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise UserError(f"{path} must have one option a line, such as `seed: 0`.")
    mapping = cast(dict[object, object], value)
    for key, entry in mapping.items():
        entries = cast(list[object], entry) if isinstance(entry, list) else [entry]
        if not isinstance(key, str):
            raise UserError(f"{path}: {key!r} is not the name of an option.")
        if not all(one is None or isinstance(one, str | bool | int | float) for one in entries):
            raise UserError(f"{path}: the option {key!r} must be a number, a string, or a list of these.")
    return cast(dict[str, Any], value)
