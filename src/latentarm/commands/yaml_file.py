"""A flat YAML file, parsed as untrusted input."""

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any, Final, cast

import yaml

from latentarm.errors import UserError
from latentarm.untrusted.opening import read_bytes

MOST_BYTES: Final = 1 << 16
"""Of a file of options."""


class _OptionLoader(yaml.SafeLoader):
    """Plain values only: no aliases, which can make a small file huge, and no key twice."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("an alias (*) is not an option's value")
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Hashable, Any]:
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        for key in keys:
            if keys.count(key) > 1:
                raise yaml.YAMLError(f"{key!r} is given twice")
        return super().construct_mapping(node, deep)


# YAML 1.1 reads 1e-3 as text because it has no decimal point.
_OptionLoader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"[-+]?[0-9]+[eE][-+]?[0-9]+"), list("-+0123456789")
)


def read_mapping(path: Path) -> dict[str, Any]:
    """The mapping from names to numbers, texts and lists of these that a file consists of.

    Raises:
        UserError: the file cannot be read, is too large, is no YAML, or is no such mapping.
    """
    content = read_bytes(path, MOST_BYTES)
    loader: _OptionLoader | None = None
    try:
        loader = _OptionLoader(content.decode())
        value: object = loader.get_single_data()
    except (yaml.YAMLError, ValueError, TypeError, RecursionError) as error:
        raise UserError(f"{path} is not a YAML file of options: {_said(error)}.") from error
    finally:
        if loader is not None:
            loader.dispose()
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


def _said(error: Exception) -> str:
    """An error in one line."""
    if isinstance(error, yaml.MarkedYAMLError) and error.problem_mark is not None:
        return f"{error.problem} in line {error.problem_mark.line + 1}"
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    return " ".join(str(error).split()) or "it is damaged"
