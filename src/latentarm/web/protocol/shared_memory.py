"""A lock-free latest-value slot (a seqlock) and a flag in shared memory."""

import ctypes
import struct
import zlib
from multiprocessing.sharedctypes import RawArray
from typing import Final, final

_VERSION_BYTES: Final = 8
_HEADER: Final = struct.Struct("<II")  # after the version: the message's length in bytes, and its checksum
_START: Final = _VERSION_BYTES + _HEADER.size
_TRIES: Final = 4


@final
class LatestSlot:
    """A lock-free slot for the newest message of one writer; older messages are lost, and nobody waits.

    The version is odd while the writer is at work. A reader takes a message only if the version was the same
    before and after, and the checksum over both is right: so a message that changed while it was read, or
    whose writer was killed half-way, is never used. The version is written in one piece; the rest need not
    be, nor in any order. A slot is passed to a new process as an argument, and is freed when the last process
    that holds it ends. ``size`` is the longest message, bytes.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._memory = RawArray(ctypes.c_uint64, -(-(_START + size) // _VERSION_BYTES))
        self._written = 0

    @property
    def version(self) -> int:
        """Changes with every message; 0 before the first."""
        return int(self._memory[0])

    def write(self, message: bytes) -> None:
        """Replace the message; only one process may do so. Raises ValueError if it is too long."""
        if len(message) > self._size:
            raise ValueError(f"a message of {len(message)} bytes is too long for {self._size}")
        view = self._view()
        self._written += 2
        self._memory[0] = self._written - 1
        _HEADER.pack_into(view, _VERSION_BYTES, len(message), _checksum(message, self._written))
        view[_START : _START + len(message)] = message
        self._memory[0] = self._written

    def read(self) -> tuple[int, bytes] | None:
        """The newest message and its version, or None if there is no complete one."""
        view = self._view()
        for _ in range(_TRIES):
            version = self.version
            if version == 0:
                return None
            length, checksum = _HEADER.unpack_from(view, _VERSION_BYTES)
            if version % 2 or length > self._size:
                continue
            message = bytes(view[_START : _START + length])
            if self.version == version and _checksum(message, version) == checksum:
                return version, message
        return None

    def _view(self) -> memoryview:
        return memoryview(self._memory).cast("B")


def _checksum(message: bytes, version: int) -> int:
    return zlib.crc32(message, version & 0xFFFFFFFF)


@final
class Flag:
    """A counter in shared memory that one process raises and others read."""

    def __init__(self) -> None:
        self._memory = RawArray(ctypes.c_uint64, 1)

    @property
    def count(self) -> int:
        """How often it was raised."""
        return int(self._memory[0])

    def raise_(self) -> None:
        """Raise it by one; only one process may do so."""
        self._memory[0] += 1
