"""The records of CSV files that others wrote, within bounds."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Final, TextIO, final

from latentarm.demonstrations.bounds import MAX_LINE, MAX_TEXT_BYTES
from latentarm.errors import UserError
from latentarm.untrusted.opening import opened

MAX_RECORD_LINES: Final = 100
"""Lines that one record may have, where its texts hold line breaks."""


def read_lines(source: Path) -> Iterator[tuple[int, list[str]]]:
    """Line numbers, from one, and fields of every record that is not empty.

    Raises:
        UserError: the file cannot be read, is too large, or is no CSV file in UTF-8.
    """
    with opened(source, MAX_TEXT_BYTES) as stream:
        lines = _Lines(io.TextIOWrapper(stream, encoding="utf-8-sig", newline=""), source)
        reader = csv.reader(lines, strict=True)
        try:
            for fields in reader:
                lines.in_record = 0
                if fields:
                    yield reader.line_num, fields
        except (UnicodeDecodeError, csv.Error) as error:
            raise UserError(
                f"{source} is not a readable CSV file in UTF-8, from about line {reader.line_num + 1} on."
            ) from error


@final
class _Lines:
    """Lines of bounded length: the parser takes as much as it is given.

    Args:
        stream: the file.
        source: its path.

    Attributes:
        in_record: lines since this was last set to zero; a text in quotation marks may go over several.
    """

    def __init__(self, stream: TextIO, source: Path) -> None:
        self._stream = stream
        self._source = source
        self._number = 0
        self.in_record = 0

    def __iter__(self) -> "_Lines":
        return self

    def __next__(self) -> str:
        line = self._stream.readline(MAX_LINE + 1)
        if not line:
            raise StopIteration
        self._number += 1
        self.in_record += 1
        if len(line) > MAX_LINE:
            raise UserError(f"{self._source}: line {self._number} has more than {MAX_LINE:,} characters.")
        if self.in_record > MAX_RECORD_LINES:
            raise UserError(
                f"{self._source}: the text that begins in line {self._number - MAX_RECORD_LINES} has no end;"
                " a quotation mark is missing."
            )
        return line
