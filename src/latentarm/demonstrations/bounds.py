"""How much one import may hold in memory: checked against what a file declares, before allocating."""

from pathlib import Path
from typing import Final

from latentarm.errors import UserError

MAX_VALUES: Final = 1 << 27
"""Numbers in one dataset: 1 GiB as float64, or 19 million samples of seven joints."""

MAX_TEXT_BYTES: Final = 1 << 28
"""Bytes of a CSV file: 256 MiB."""

MAX_JSON_BYTES: Final = 1 << 24
"""Bytes of a metadata document: 16 MiB."""


def check_values(source: Path, what: str, count: int) -> None:
    """Refuse more numbers than an import may hold.

    Args:
        source: file that declares the numbers.
        what: what they are, for the message.
        count: how many the file declares.

    Raises:
        UserError: there are more than `MAX_VALUES`.
    """
    if count > MAX_VALUES:
        raise UserError(
            f"{source}: {what} declares {count:,} numbers, over the limit of {MAX_VALUES:,}; split the file."
        )


def check_bytes(source: Path, limit: int) -> None:
    """Refuse a file that is longer than ``limit`` bytes, or that cannot be read.

    Raises:
        UserError: see above.
    """
    try:
        size = source.stat().st_size
    except OSError as error:
        raise UserError(f"{source} cannot be read: {error.strerror or error}.") from error
    if size > limit:
        raise UserError(f"{source} has {size:,} bytes, over the limit of {limit:,}; split the file.")
