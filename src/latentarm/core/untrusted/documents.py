"""JSON that this program may not have written: bounded before it is parsed, strict while it is.

Python's parser builds whatever it is given: 16 MB of ``[],[],`` take 400 MB, ``1e999`` becomes infinite,
the last of two equal keys wins, and walking a deep document later can exhaust the stack.
"""

import json
import math
import re
from collections.abc import Mapping
from itertools import accumulate
from pathlib import Path
from typing import Any, Final, cast

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import read_bytes

MOST_BYTES: Final = 1 << 24  # largest document: 16 MiB
MOST_VALUES: Final = 1_000_000  # values in a document, containers included; at worst 100 MB as Python objects
MOST_LEVELS: Final = 32  # nesting depth of containers
MOST_TEXT_BYTES: Final = 1 << 16  # length of one string as written in the document
MOST_DIGITS: Final = 20  # digits of an integer; more than a 64-bit one can have

_NO_BRACKETS: Final = bytes(set(range(256)) - set(b"[]{}"))
_SURROGATE: Final = re.compile(rb"\\u[dD][89a-fA-F]")


class _FaultError(ValueError):
    """Says what is wrong with a document, as the end of a sentence."""


def read_object(path: Path, limit: int = MOST_BYTES) -> dict[str, Any]:
    """The JSON object in a file of at most ``limit`` bytes."""
    return parse_object(read_bytes(path, limit), str(path))


def parse_object(document: bytes | str, where: str) -> dict[str, Any]:
    """The JSON object in a document in UTF-8; ``where`` names the document in errors."""
    try:
        content = document.encode() if isinstance(document, str) else document
        _check_shape(content)
        value: object = json.loads(
            content.decode(),
            parse_constant=_no_constant,
            parse_float=_finite,
            parse_int=_integer,
            object_pairs_hook=_without_repeats,
        )
        if _SURROGATE.search(content):
            _check_texts(value)
    except _FaultError as error:
        raise UserError(f"{where} cannot be used: it {error}.") from error
    except json.JSONDecodeError as error:
        said = f"{error.msg[:1].lower()}{error.msg[1:]}"
        raise UserError(
            f"{where} is not a JSON document: line {error.lineno}, column {error.colno}: {said}."
        ) from error
    except (ValueError, RecursionError) as error:
        raise UserError(f"{where} is not a JSON document in UTF-8; it is truncated or damaged.") from error
    if not isinstance(value, dict):
        raise UserError(f"{where} is JSON but not an object with named fields.")
    return cast(dict[str, Any], value)


def _check_shape(content: bytes) -> None:
    """Bound the parser's output by cheap passes over the bytes."""
    if len(content) > MOST_BYTES:
        raise _FaultError(f"has more than {MOST_BYTES:,} bytes")
    # Without escapes every quotation mark begins or ends a text.
    plain = content.replace(b"\\\\", b"--").replace(b'\\"', b"--")
    if plain.count(b'"') > 4 * MOST_VALUES:
        raise _FaultError(f"holds more than {MOST_VALUES:,} values")
    parts = plain.split(b'"')
    if max(map(len, parts[1::2]), default=0) > MOST_TEXT_BYTES:
        raise _FaultError(f"holds a text of more than {MOST_TEXT_BYTES:,} bytes")
    outside = b"".join(parts[::2])
    if sum(outside.count(mark) for mark in (b",", b"[", b"{")) >= MOST_VALUES:
        raise _FaultError(f"holds more than {MOST_VALUES:,} values")
    brackets = outside.translate(None, _NO_BRACKETS)
    if max(accumulate(1 if bracket in b"[{" else -1 for bracket in brackets), default=0) > MOST_LEVELS:
        raise _FaultError(f"is nested deeper than {MOST_LEVELS} levels")


def _no_constant(name: str) -> float:
    raise _FaultError(f"holds {name}, which is not a number")


def _finite(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        raise _FaultError("holds a number too large for a computer")
    return value


def _integer(digits: str) -> int:
    if len(digits.lstrip("-")) > MOST_DIGITS:
        raise _FaultError(f"holds a whole number of more than {MOST_DIGITS} digits")
    return int(digits)


def _without_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values = dict(pairs)
    if len(values) < len(pairs):
        raise _FaultError("has a field twice")
    return values


def _check_texts(document: object) -> None:
    """Refuse escapes of half a character, which no file and no terminal can hold."""
    waiting: list[object] = [document]
    while waiting:
        value = waiting.pop()
        if isinstance(value, str):
            try:
                value.encode()
            except UnicodeEncodeError as error:
                raise _FaultError("holds a text that is not Unicode") from error
        elif isinstance(value, list):
            waiting.extend(cast(list[object], value))
        elif isinstance(value, dict):
            mapping = cast(Mapping[str, object], value)
            waiting.extend(mapping)
            waiting.extend(mapping.values())
