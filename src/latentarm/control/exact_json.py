"""Values of the control loop as JSON, and back, to the last bit."""

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np


def to_json(value: object) -> Any:
    """A value as JSON can hold it: records by their type's name, arrays as hexadecimal bytes.

    Args:
        value: anything; what no loop can use becomes None.
    """
    match value:
        case float():
            return float(value) if math.isfinite(value) else {"float": str(float(value))}
        case str():
            return value.encode(errors="replace").decode()[:1000]
        case bool() | None:
            return value
        case int():
            return value if abs(value) < 1 << 62 else None
        case np.ndarray():
            if value.dtype.kind not in "iuf":
                return to_json(value.tolist())  # of no use to a loop, and so refused again
            return {"array": value.astype("<f8").tobytes().hex(), "shape": list(value.shape)}
        case np.generic():
            return to_json(value.item())
        case tuple() | list():
            return [to_json(one) for one in value]
        case Mapping():
            return {"mapping": {str(key): to_json(one) for key, one in value.items()}}
        case Path():
            return {"path": str(value)}
        case _ if is_dataclass(value):
            named = {field.name: to_json(getattr(value, field.name)) for field in fields(value)}
            return {"record": type(value).__name__, "fields": named}
        case _:
            return None


def of_json(document: Any, kinds: Mapping[str, type]) -> Any:
    """What `to_json` was given; lists are tuples.

    Args:
        document: untrusted.
        kinds: the records that may be in it, by name.

    Raises:
        KeyError: a record is of another kind.
        TypeError, ValueError, UserError: a record or an array is damaged.
    """
    match document:
        case {"float": text}:
            return float(text)
        case {"array": content, "shape": shape}:
            return np.frombuffer(bytes.fromhex(content), "<f8").reshape(shape).astype(np.float64)
        case {"mapping": entries}:
            return {key: of_json(one, kinds) for key, one in entries.items()}
        case {"path": text}:
            return Path(text)
        case {"record": name, "fields": named}:
            return kinds[name](**{key: of_json(one, kinds) for key, one in named.items()})
        case list():
            return tuple(of_json(one, kinds) for one in document)
        case _:
            return document
