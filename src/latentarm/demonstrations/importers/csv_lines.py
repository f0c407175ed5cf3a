"""The records of CSV files by any writer, within bounds.

The first line decides the separator: comma, semicolon or tab, whichever is most frequent. A comma within a
number is a decimal comma. Files may be packed with gzip.
"""

import csv
import gzip
import io
import zlib
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Final, TextIO, final

from latentarm.core.errors import UserError
from latentarm.core.untrusted.opening import opened
from latentarm.demonstrations.bounds import MAX_LINE, MAX_TEXT_BYTES

GZIP: Final = b"\x1f\x8b"  # first bytes of a packed file
MAX_RECORD_LINES: Final = 100  # of one record, whose texts may hold line breaks


def read_lines(source: Path) -> Iterator[tuple[int, list[str]]]:
    """Line numbers, from one, and fields of every non-empty record."""
    with opened(source, MAX_TEXT_BYTES) as stream:
        packed = stream.read(len(GZIP)) == GZIP
        stream.seek(0)
        content = gzip.GzipFile(fileobj=stream) if packed else stream
        lines = _Lines(io.TextIOWrapper(content, encoding="utf-8-sig", newline=""), source)
        try:
            first = next(lines, "")
            delimiter = max(",;\t", key=first.count)
            reader = csv.reader(chain([first], lines), delimiter=delimiter, strict=True)
            for fields in reader:
                lines.in_record = 0
                if fields:
                    yield reader.line_num, fields
        except (UnicodeDecodeError, csv.Error, EOFError, zlib.error) as error:
            raise UserError(
                f"{source} is not a readable CSV file in UTF-8, from about line {lines.number + 1} on."
            ) from error


@final
class CsvTable:
    """A table whose first line names its columns, in ``header``."""

    def __init__(self, source: Path) -> None:
        self.source = source
        self._lines = read_lines(source)
        self.header = [name.strip() for name in next(self._lines, (0, []))[1]]

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line numbers and fields of all further records."""
        number = 0
        for number, fields in self._lines:
            if len(fields) != len(self.header):
                raise UserError(
                    f"{self.source}: line {number} is ragged: {len(fields)} fields under {len(self.header)}"
                    " columns."
                )
            yield number, fields
        if not number:
            raise UserError(f"{self.source} has no line after its header.")

    def number(self, text: str, line: int, column: str) -> float:
        """A field's number."""
        try:
            return float(text if "." in text else text.replace(",", ".", 1))
        except ValueError as error:
            raise UserError(
                f"{self.source}: line {line}, column {column!r}: {text[:40]!r} is not a number."
            ) from error


@final
class _Lines:
    """Lines of bounded length. ``in_record`` counts those since a reader set it to zero."""

    def __init__(self, stream: TextIO, source: Path) -> None:
        self._stream, self._source = stream, source
        self._characters = 0
        self.number = 0
        self.in_record = 0

    def __iter__(self) -> "_Lines":
        return self

    def __next__(self) -> str:
        line = self._stream.readline(MAX_LINE + 1)
        if not line:
            raise StopIteration
        self.number += 1
        self.in_record += 1
        self._characters += len(line)
        if self._characters > MAX_TEXT_BYTES:  # a packed file can hold a thousand times its size
            raise UserError(f"{self._source} holds more than {MAX_TEXT_BYTES:,} characters; split it.")
        if len(line) > MAX_LINE:
            raise UserError(f"{self._source}: line {self.number} has more than {MAX_LINE:,} characters.")
        if self.in_record > MAX_RECORD_LINES:
            raise UserError(
                f"{self._source}: the text that begins in line {self.number - MAX_RECORD_LINES} has no end;"
                " a quotation mark is missing."
            )
        return line
