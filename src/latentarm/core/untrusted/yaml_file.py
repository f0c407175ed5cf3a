"""YAML that this program may not have written: plain values only."""

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from latentarm.core.errors import UserError


class _PlainLoader(yaml.SafeLoader):
    """Plain values only: no aliases, which can make a small file huge, and no key twice."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("an alias (*) is not a plain value")
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Hashable, Any]:
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        for key in keys:
            if keys.count(key) > 1:
                raise yaml.YAMLError(f"{key!r} is given twice")
        return super().construct_mapping(node, deep)


# YAML 1.1 reads 1e-3 as text because it has no decimal point.
_PlainLoader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"[-+]?[0-9]+[eE][-+]?[0-9]+"), list("-+0123456789")
)


def parse_yaml(content: bytes, path: Path, kind: str) -> object:
    """The value in a file's content, None where it is empty; ``kind`` says in errors what it should be."""
    loader: _PlainLoader | None = None
    try:
        loader = _PlainLoader(content.decode())
        return loader.get_single_data()
    except (yaml.YAMLError, ValueError, TypeError, RecursionError) as error:
        raise UserError(f"{path} is not {kind}: {_said(error)}.") from error
    finally:
        if loader is not None:
            loader.dispose()


def _said(error: Exception) -> str:
    if isinstance(error, yaml.MarkedYAMLError) and error.problem_mark is not None:
        return f"{error.problem} in line {error.problem_mark.line + 1}"
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    return " ".join(str(error).split()) or "it is damaged"
