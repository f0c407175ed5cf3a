"""Memory limits for one import, checked against what a file declares before anything is allocated."""

from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError

MAX_VALUES: Final = 1 << 27  # numbers in one dataset: 1 GiB as float64, 19 million samples of seven joints
MAX_EPISODES: Final = 100_000  # episodes in one dataset
MAX_COLUMNS: Final = 1024  # columns of a table
MAX_TEXT_BYTES: Final = 1 << 28  # bytes of a CSV file: 256 MiB
MAX_LINE: Final = 1 << 16  # characters of a line in a CSV file
MAX_FILE_BYTES: Final = 1 << 34  # bytes of any other file: 16 GiB; pictures in it are not read


def check_values(source: Path, what: str, count: int) -> None:
    """Refuse more numbers than an import may hold."""
    if count > MAX_VALUES:
        raise UserError(
            f"{source}: {what} declares {count:,} numbers, over the limit of {MAX_VALUES:,}; split the file."
        )
