"""Folders that one program at a time writes atomically."""

import os
import shutil
from collections.abc import Generator, Iterable
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from latentarm.core.errors import UserError
from latentarm.core.files import sync_folder


@contextmanager
def locked(folder: Path, lock_file: Path, remedy: str = "wait for it") -> Generator[None]:
    """Keep other writers out of ``folder`` until the block or the process ends."""
    if not lock_file.parent.is_dir():
        raise UserError(f"{folder} cannot be opened: there is no such folder.")
    lock = FileLock(lock_file, blocking=False)
    try:
        lock.acquire()
    except Timeout as error:
        raise UserError(f"The folder {folder} is being written by another program; {remedy}.") from error
    except OSError as error:
        raise UserError(f"{folder} cannot be locked: {error.strerror or error}.") from error
    try:
        yield
    finally:
        with suppress(OSError):  # Windows removes no open file; filelock does it there on release
            lock_file.unlink()
        lock.release()


def check_vacant(destination: Path) -> None:
    """Refuse a destination that is not empty."""
    try:
        if destination.is_dir():
            if any(destination.iterdir()):
                raise UserError(f"{destination} already exists and is not empty; choose another place.")
        elif os.path.lexists(destination):
            raise UserError(f"{destination} already exists and is not a folder; choose another place.")
    except OSError as error:
        raise UserError(f"{destination} cannot be written: {error.strerror or error}.") from error


@contextmanager
def staged_folder(destination: Path) -> Generator[Path]:
    """Yield a folder beside ``destination``; on success rename it there.

    On any error nothing remains. After a kill the staging folder ``.NAME.part`` and the lock file
    ``.NAME.lock`` remain, until the next attempt at the same destination removes them.
    """
    destination = destination.resolve()
    check_vacant(destination)
    staging = destination.parent / f".{destination.name}.part"
    try:
        destination.parent.mkdir(parents=True, exist_ok=True)
        # Beside the staging folder, because Windows renames no folder that holds an open file.
        with locked(destination, destination.parent / f".{destination.name}.lock"):
            try:
                staging.mkdir(exist_ok=True)
                _clear(staging)
                yield staging
                check_vacant(destination)
                staging.replace(destination)
                sync_folder(destination.parent)
            except BaseException:
                shutil.rmtree(staging, ignore_errors=True)
                raise
    except OSError as error:
        raise UserError(f"{destination} cannot be written: {error.strerror or error}.") from error


def remove_files(paths: Iterable[Path]) -> None:
    """Delete files, or say which one cannot be deleted."""
    for path in paths:
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise UserError(f"{path} cannot be deleted: {error.strerror or error}.") from error


def _clear(folder: Path) -> None:
    for entry in folder.iterdir():
        if entry.is_dir() and not entry.is_symlink():
            shutil.rmtree(entry)
        else:
            entry.unlink()
