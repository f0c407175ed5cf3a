"""Frozen records from JSON, strictly: every field is there, is known, and has its kind."""

from collections.abc import Sequence
from dataclasses import MISSING, fields, is_dataclass
from math import isfinite
from types import UnionType
from typing import Any, Literal, TypeVar, cast, get_args, get_origin, get_type_hints

from latentarm.core.errors import UserError

Record = TypeVar("Record")

PLAIN = {str: "text", bool: "true or false", int: "a whole number", float: "a finite number"}
"""What a field that holds one value must be, in words."""


def read_record(kind: type[Record], entry: object, where: str) -> Record:
    """A record from a JSON object that has its fields, those with defaults optional, and no others.

    Args:
        kind: a dataclass of texts, numbers, literals, tuples and dataclasses.
        entry: as JSON was parsed.
        where: file and field, for messages.

    Raises:
        UserError: a field is missing, unknown, or not what it should be; or the record itself refuses.
    """
    if not isinstance(entry, dict):
        raise UserError(f"{where} must be an object with named fields.")
    given = cast(dict[str, Any], entry)
    hints = get_type_hints(kind)
    known = {field.name: field for field in fields(cast(Any, kind))}
    for name in given:
        if name not in known:
            raise UserError(f"{where} has the unknown field {name!r}: it knows {', '.join(known)}.")
    missing = [name for name, field in known.items() if name not in given and field.default is MISSING]
    if missing:
        raise UserError(f"{where} lacks the field {missing[0]!r}.")
    values = {name: _value(hints[name], value, f"{where}: {name}") for name, value in given.items()}
    try:
        return kind(**values)
    except UserError as error:
        raise UserError(f"{where}: {error}") from error


def _value(hint: Any, value: object, where: str) -> Any:
    origin = get_origin(hint)
    if origin is Literal:
        if value not in get_args(hint) or isinstance(value, bool):
            raise UserError(f"{where} must be one of {', '.join(get_args(hint))}, not {value!r}.")
        return value
    if origin is tuple:
        return _values(get_args(hint), value, where)
    if origin is UnionType:
        inner = next(one for one in get_args(hint) if one is not type(None))
        return None if value is None else _value(inner, value, where)
    if is_dataclass(hint):
        return read_record(cast(type[Any], hint), value, where)
    return _plain(hint, value, where)


def _values(hints: Sequence[Any], value: object, where: str) -> tuple[Any, ...]:
    if not isinstance(value, list):
        raise UserError(f"{where} must be a list.")
    entries = cast(list[object], value)
    if hints[-1] is ...:
        hints = [hints[0]] * len(entries)
    if len(hints) != len(entries):
        raise UserError(f"{where} must have {len(hints)} entries, not {len(entries)}.")
    places = enumerate(zip(hints, entries, strict=True), start=1)
    return tuple(_value(hint, one, f"{where}, entry {place}") for place, (hint, one) in places)


def _plain(hint: type, value: object, where: str) -> object:
    if hint is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    fits = isinstance(value, hint) and (hint is bool or not isinstance(value, bool))
    if not fits or (isinstance(value, float) and not isfinite(value)):
        raise UserError(f"{where} must be {PLAIN[hint]}.")
    if isinstance(value, str) and not value.replace("\n", " ").isprintable():
        raise UserError(f"{where} holds a character that cannot be printed.")
    return value
