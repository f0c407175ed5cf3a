"""Opening files that this program may not have written: regular files of bounded size only.

Every reader of files goes through here, so that a named pipe, a device or an endless file is refused.
Symbolic links are followed, and their targets obey the same rules.
"""

import os
import stat
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from latentarm.core.errors import UserError

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def check_file(path: Path, limit: int) -> None:
    """Refuse anything but a readable regular file of limited size, for libraries that open paths."""
    with opened(path, limit):
        pass


@contextmanager
def opened(path: Path, limit: int) -> Generator[BinaryIO]:
    """Open a file for reading, and turn any failure into a one-sentence error."""
    try:
        # Check before opening: opening a device can have side effects.
        _check(path, path.stat(), limit)
        # If the file was replaced by a pipe meanwhile, this returns instead of waiting for a writer.
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with os.fdopen(descriptor, "rb") as stream:
            _check(path, os.fstat(descriptor), limit)
            yield stream
    except OSError as error:
        raise UserError(f"{path} cannot be read: {error.strerror or error}.") from error
    except ValueError as error:
        if "null byte" not in str(error):
            raise
        raise UserError(f"{str(path)!a} is not a path that a file can have.") from error


def read_bytes(path: Path, limit: int) -> bytes:
    """A file's whole content, of at most ``limit`` bytes."""
    with opened(path, limit) as stream:
        content = stream.read(limit + 1)
    if len(content) > limit:
        raise _too_large(path, "more", limit)
    return content


def is_missing(path: Path) -> bool:
    """Whether nothing exists at ``path``."""
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return True
    except (OSError, ValueError):  # reading it says what is wrong, such as a null byte in the path
        return False
    return False


def _check(path: Path, status: os.stat_result, limit: int) -> None:
    if not stat.S_ISREG(status.st_mode):
        kind = _KINDS.get(stat.S_IFMT(status.st_mode), "something else")
        raise UserError(f"{path} is {kind}, not a file.")
    if status.st_size > limit:
        raise _too_large(path, f"{status.st_size:,} bytes", limit)


def _too_large(path: Path, size: str, limit: int) -> UserError:
    return UserError(f"{path} is too large: it has {size}, and at most {limit:,} bytes are read.")
