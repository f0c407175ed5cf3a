"""Records on disk: one JSON document a file, checked when it is read and written whole or not at all."""

import re
import secrets
from collections.abc import Generator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Final, TypeVar

from pydantic import BaseModel, ValidationError

from latentarm.core.errors import UserError
from latentarm.core.files import write_text
from latentarm.core.untrusted.documents import parse_object
from latentarm.core.untrusted.opening import read_bytes
from latentarm.core.untrusted.terminal import one_line
from latentarm.web.protocol.notice import Notice

DOCUMENT_LIMIT: Final = 1 << 17

ID: Final = re.compile(r"[0-9a-f]{16}")  # ids of people and drives: random, and so never a path or a name

Record = TypeVar("Record", bound=BaseModel)


def new_id() -> str:
    """A random id, 64 bits."""
    return secrets.token_hex(8)


def stamp() -> str:
    """The time as records keep it: ISO 8601 in UTC, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def read_record(kind: type[Record], path: Path) -> Record:
    """A record from its file. Raises UserError if it is missing, too large, damaged or no such record."""
    return parse_record(kind, read_bytes(path, DOCUMENT_LIMIT), str(path))


def parse_record(kind: type[Record], content: bytes, where: str) -> Record:
    """A record from UTF-8 JSON. Raises UserError, with ``where``, if it is damaged or no such record."""
    parse_object(content, where)
    try:
        return kind.model_validate_json(content)
    except ValidationError as error:
        raise UserError(f"{where} is not a record of this version, or was changed by hand.") from error


@contextmanager
def disk_errors(path: Path, undone: str) -> Generator[None]:
    """Report an `OSError` as "``path`` cannot be ``undone``"."""
    try:
        yield
    except OSError as error:
        raise UserError(f"{path} cannot be {undone}: {error.strerror or error}.") from error


def unreadable(error: UserError) -> Notice:
    """The notice for a record that cannot be read."""
    return Notice(code="record_unreadable", parameters={"text": one_line(str(error))})


def write_record(record: BaseModel, path: Path) -> None:
    """Write a record to its file. Raises UserError as `write_text` does."""
    write_text(path, record.model_dump_json(indent=1) + "\n")
