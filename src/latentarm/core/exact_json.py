"""Values of the control loop as JSON, and back, to the last bit."""

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np


def to_json(value: object) -> Any:
    """A value as JSON: arrays as hexadecimal bytes, records with their type's name, unusable ones as None."""
    match value:
        case bool() | None:
            return value
        case float():
            return float(value) if math.isfinite(value) else {"float": str(float(value))}
        case str():
            return value.encode(errors="replace").decode()[:1000]
        case int():
            return value if abs(value) < 1 << 62 else None
        case np.ndarray() if value.dtype.kind in "iuf":
            return {"array": value.astype("<f8").tobytes().hex(), "shape": list(value.shape)}
        case np.generic() | np.ndarray():
            return to_json(value.tolist())
        case tuple() | list():
            return [to_json(one) for one in value]
        case Path():
            return str(value)
        case Mapping():
            return {"record": "dict", "fields": {str(key): to_json(one) for key, one in value.items()}}
        case _ if is_dataclass(value):
            named = {name: to_json(getattr(value, name)) for name in _names(type(value))}
            return {"record": type(value).__name__, "fields": named}
        case _:
            return None


def as_text_json(value: object) -> Any:
    """A value as JSON for people to read: arrays as lists, records by their fields; exact as well."""
    match value:
        case np.ndarray():
            return as_text_json(value.tolist())
        case float() if not math.isfinite(value):
            return str(value)
        case tuple() | list():
            return [as_text_json(one) for one in value]
        case _ if is_dataclass(value):
            return {name: as_text_json(getattr(value, name)) for name in _names(type(value))}
        case _:
            return value if isinstance(value, str | int | float | None) else str(value)


@cache
def _names(kind: type[Any]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind))


def of_json(document: Any, *kinds: type) -> Any:
    """The inverse of `to_json` for an untrusted document; lists become tuples, and paths text.

    Only the given kinds of records may be in it.

    Raises:
        TypeError, ValueError, UserError: a record is damaged or of another kind, or an array is damaged.
    """
    match document:
        case {"float": text}:
            return float(text)
        case {"array": content, "shape": shape}:
            return np.frombuffer(bytes.fromhex(content), "<f8").reshape(shape).astype(np.float64)
        case {"record": name, "fields": named}:
            (kind,) = (kind for kind in (*kinds, dict) if kind.__name__ == name)
            return kind(**{key: of_json(one, *kinds) for key, one in named.items()})
        case list():
            return tuple(of_json(one, *kinds) for one in document)
        case _:
            return document
