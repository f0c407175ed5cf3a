"""Tables in HDF5 files by any writer: plain ones of this file, within bounds.

The HDF5 library is not hardened: a maliciously damaged file may end the whole process. Even then the
destination of an import stays empty, because it is written only after all reading.
"""

import math
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

import h5py
import numpy as np

from latentarm.core.errors import UserError
from latentarm.core.types import FloatArray
from latentarm.core.untrusted.opening import check_file
from latentarm.demonstrations.bounds import MAX_FILE_BYTES

MAX_CHUNKS: Final = 100_000  # of one table; each needs a look-up


@contextmanager
def opened_hdf5(source: Path) -> Generator[h5py.File]:
    """Open a file, and turn any damage into a `UserError`."""
    check_file(source, MAX_FILE_BYTES)
    try:
        with h5py.File(source, "r") as file:
            yield file
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, OverflowError) as error:
        raise UserError(f"{source} is not a whole HDF5 file; it is truncated or damaged.") from error


def group(parent: h5py.Group, name: str, source: Path) -> h5py.Group:
    """The group of that name in this file."""
    found = member(parent, name)
    if not isinstance(found, h5py.Group):
        raise UserError(f"{source} has no group {path_in(parent, name)}.")
    return found


def member(parent: h5py.Group, name: str) -> object:
    """A member that lies in this file itself: links could lead to any other file."""
    return parent[name] if isinstance(parent.get(name, getlink=True), h5py.HardLink) else None


def path_in(parent: h5py.Group, name: str) -> str:
    """Path of a member, for messages."""
    return f"{parent.name}/{name}".lstrip("/")


def table(parent: h5py.Group, name: str, source: Path) -> FloatArray | None:
    """A plain dataset of numbers (T, k), or None where there is none."""
    found = member(parent, name)
    if not isinstance(found, h5py.Dataset):
        return None
    if found.is_virtual or found.external or found.dtype.kind not in "fiu" or found.ndim != 2:
        raise UserError(f"{source}: {path_in(parent, name)} is not a plain table of numbers.")
    pieces = zip(found.shape, found.chunks or found.shape, strict=True)
    if math.prod(-(-length // max(chunk, 1)) for length, chunk in pieces) > MAX_CHUNKS:
        raise UserError(f"{source}: {path_in(parent, name)} has over {MAX_CHUNKS:,} chunks: repack the file.")
    return np.asarray(found[()], dtype=np.float64)
