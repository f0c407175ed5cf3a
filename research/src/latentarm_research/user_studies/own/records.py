"""Frozen records from JSON, strictly: every field is there, is known, and has its kind."""

import json
from collections.abc import Iterator
from functools import cache
from typing import Any, TypeVar, cast

from pydantic import TypeAdapter, ValidationError

from latentarm.core.errors import UserError

Record = TypeVar("Record")


@cache
def _adapter(kind: type[Record]) -> TypeAdapter[Record]:
    return TypeAdapter(kind)


def read_record(
    kind: type[Record],
    entry: object,  # as JSON was parsed
    where: str,
) -> Record:
    """A record from a JSON object that has its fields, those with defaults optional, and no others."""
    for text in _texts(entry):
        if not text.replace("\n", " ").isprintable():
            raise UserError(f"{where}: {text!r} holds a character that cannot be printed.")
    try:
        return _adapter(kind).validate_json(json.dumps(entry), strict=True, extra="forbid")
    except ValidationError as error:
        raise UserError(f"{where}{_said(cast(dict[str, Any], error.errors()[0]))}") from error
    except UserError as error:
        raise UserError(f"{where}: {error}") from error


def _said(fault: dict[str, Any]) -> str:
    *place, last = fault["loc"] or ("",)
    inner = "".join(f", entry {part + 1}" if isinstance(part, int) else f": {part}" for part in place)
    if fault["type"] in ("missing", "missing_argument"):
        return f"{inner} lacks the field {last!r}."
    if fault["type"] in ("extra_forbidden", "unexpected_keyword_argument"):
        return f"{inner} has the unknown field {last!r}: leave it out."
    named = f", entry {last + 1}" if isinstance(last, int) else f": {last}"
    return f"{inner}{named} {fault['msg'].replace('Input should', 'must')}."


def _texts(entry: object) -> Iterator[str]:
    if isinstance(entry, str):
        yield entry
    elif isinstance(entry, list | dict):
        inner = (
            cast("dict[str, object]", entry).values()
            if isinstance(entry, dict)
            else cast("list[object]", entry)
        )
        for one in inner:
            yield from _texts(one)
