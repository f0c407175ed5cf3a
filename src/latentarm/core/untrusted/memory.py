"""A bound on the memory that reading a file may take, for C parsers that have no limit of their own.

A page of a Parquet file, a chunk of an HDF5 file or a texture of a robot model can unpack to a thousand times
its size. On Linux the operating system limits how much the process may grow during the read, and the library
then fails to allocate. Elsewhere only the readers' own checks of declared sizes hold.
"""

import threading
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from latentarm.core.errors import UserError

try:
    import resource
except ImportError:  # Windows
    resource = None

ALLOWANCE: Final = 256 << 20  # memory that any file may take, bytes
PER_BYTE: Final = 64  # of the file: numbers are packed well where an arm stands still

_STATUS: Final = Path("/proc/self/status")
_UNLIMITED: Final = 1 << 62
_lock = threading.Lock()
_bounds: list[int] = []  # limits of all current readers, after the original limit; the smallest applies


@contextmanager
def bounded_memory(what: str, size: int) -> Generator[None]:
    """Limit how much the process may grow during a read of ``size`` bytes; ``what`` names it in errors.

    The bound holds for the whole process: another thread that needs more also gets a `MemoryError`.
    """
    allowed = ALLOWANCE + PER_BYTE * size
    try:
        with _bound(allowed):
            yield
    except MemoryError as error:
        raise UserError(
            f"{what} takes more than {allowed >> 20:,} MiB of memory to read, out of proportion to its"
            f" {size:,} bytes: it is damaged, or made to exhaust the memory."
        ) from error


@contextmanager
def _bound(allowed: int) -> Generator[None]:
    used = _used()
    if resource is None or used is None:
        yield
        return
    with _lock:
        before, hard = resource.getrlimit(resource.RLIMIT_DATA)
        if not _bounds:
            _bounds.append(_UNLIMITED if before == resource.RLIM_INFINITY else before)
        bound = used + allowed
        _bounds.append(bound)
        resource.setrlimit(resource.RLIMIT_DATA, (min(_bounds), hard))
    try:
        yield
    finally:
        with _lock:
            _bounds.remove(bound)
            least = min(_bounds)
            resource.setrlimit(
                resource.RLIMIT_DATA, (resource.RLIM_INFINITY if least == _UNLIMITED else least, hard)
            )
            if len(_bounds) == 1:
                _bounds.clear()


def _used() -> int | None:
    try:
        lines = _STATUS.read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    return next((int(line.split()[1]) << 10 for line in lines if line.startswith("VmData:")), None)
