"""How large a journal may grow, and whether it is still where it was put."""

import math
import shutil
from dataclasses import dataclass, fields
from pathlib import Path
from typing import final

from latentarm.core.errors import UserError

_ATTACHED = ("", "-wal")  # endings of the files that belong to a journal while it is written


@final
class JournalFullError(UserError):
    """The journal may not grow further.

    Attributes:
        disk: whether the disk has no room left
        ended_episode: whether this ended an episode, which is then complete
    """

    def __init__(self, message: str, *, disk: bool) -> None:
        super().__init__(message)
        self.disk = disk
        self.ended_episode = False


@final
class JournalLostError(UserError):
    """The journal's file was deleted or replaced, with all that it recorded."""


@final
@dataclass(frozen=True)
class JournalLimits:
    """The room that a journal may take; both figures are whole numbers of bytes."""

    most_bytes: int = 4_000_000_000
    least_free_bytes: int = 500_000_000  # of the disk

    def __post_init__(self) -> None:
        for field in fields(self):
            value: object = getattr(self, field.name)
            if not isinstance(value, int) or isinstance(value, bool) or value < 0:
                raise UserError(
                    f"The journal's limit {field.name} must be a whole number of bytes, not {value!r}."
                )

    @staticmethod
    def of_gigabytes(most: float, least_free: float) -> "JournalLimits":
        """Limits from figures in GB."""
        for name, value in (("most-gb", most), ("keep-free-gb", least_free)):
            if not (math.isfinite(value) and value >= 0.0):
                raise UserError(f"--{name} is {value:g}: give a number of GB that is not negative.")
        return JournalLimits(round(most * 1e9), round(least_free * 1e9))


@final
class JournalWatch:
    """Watches the files of an existing journal while they are written."""

    def __init__(self, path: Path, limits: JournalLimits) -> None:
        self._path = path
        self._limits = limits
        self._known: dict[str, tuple[int, int]] = {}

    def check(self) -> None:
        """Check that the files exist, are still the same files, and have room.

        Raises:
            JournalLostError: a file was deleted, moved or replaced, or the folder has gone.
            JournalFullError: a limit is reached.
        """
        size = sum(self._size(ending) for ending in _ATTACHED)
        if size >= self._limits.most_bytes:
            raise JournalFullError(
                f"The journal {self._path} has reached its limit of {_said(self._limits.most_bytes)}: the"
                " recording was ended. What was recorded is kept; begin another journal or raise the limit.",
                disk=False,
            )
        free = self._free_bytes()
        if free < self._limits.least_free_bytes:
            raise JournalFullError(
                f"Only {_said(free)} are free on the disk of {self._path}, but"
                f" {_said(self._limits.least_free_bytes)} must stay free: the recording was ended. What was"
                " recorded is kept; free some space before recording more.",
                disk=True,
            )

    def _free_bytes(self) -> int:
        try:
            return shutil.disk_usage(self._path.parent).free
        except OSError as error:
            raise self._lost() from error

    def _size(self, ending: str) -> int:
        try:
            found = Path(f"{self._path}{ending}").stat()
        except FileNotFoundError as error:
            if ending and ending not in self._known:
                return 0
            raise self._lost() from error
        except OSError as error:
            raise self._lost() from error
        identity = (found.st_dev, found.st_ino)
        if self._known.setdefault(ending, identity) != identity:
            raise self._lost()
        return found.st_size

    def _lost(self) -> JournalLostError:
        return JournalLostError(
            f"The journal {self._path} was deleted, moved or replaced while it was in use: what was recorded"
            " in it is lost. Record it again."
        )


def _said(size: int) -> str:
    return f"{size / 1e9:.3g} GB" if size >= 1e8 else f"{size / 1e6:.3g} MB"
