"""Memory that two processes share without ever waiting for each other."""

import ctypes
import struct
import zlib
from multiprocessing.sharedctypes import RawArray
from typing import Final, final

_HEADER: Final = struct.Struct("<QII")
"""Version of the content, its length in bytes, and its checksum."""

_TRIES: Final = 4


@final
class LatestSlot:
    """Holds the newest message of one writer for any readers; older ones are lost, and nobody waits.

    The version is odd while the writer is at it. A reader takes a message only if the version was the
    same before and after, and its checksum is right: so one that was changed while it was read, or whose
    writer was killed half-way, is never taken for a message. A slot is handed to a new process as an
    argument, and goes when the last process that holds it ends.

    Args:
        size: the longest message, bytes.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._memory = RawArray(ctypes.c_ubyte, _HEADER.size + size)
        self._written = 0

    @property
    def version(self) -> int:
        """Changes with every message; 0 before the first."""
        return int(_HEADER.unpack_from(self._view())[0])

    def write(self, message: bytes) -> None:
        """Replace the message; one process alone may do so.

        Raises:
            ValueError: the message is too long for the slot.
        """
        if len(message) > self._size:
            raise ValueError(f"a message of {len(message)} bytes is too long for {self._size}")
        view = self._view()
        self._written += 2
        checksum = zlib.crc32(message)
        _HEADER.pack_into(view, 0, self._written - 1, len(message), checksum)
        view[_HEADER.size : _HEADER.size + len(message)] = message
        _HEADER.pack_into(view, 0, self._written, len(message), checksum)

    def read(self) -> tuple[int, bytes] | None:
        """The newest message and its version, or None where there is none that is whole."""
        view = self._view()
        for _ in range(_TRIES):
            version, length, checksum = _HEADER.unpack_from(view)
            if version == 0:
                return None
            if version % 2 or length > self._size:
                continue
            message = bytes(view[_HEADER.size : _HEADER.size + length])
            if _HEADER.unpack_from(view)[0] == version and zlib.crc32(message) == checksum:
                return version, message
        return None

    def _view(self) -> memoryview:
        return memoryview(self._memory).cast("B")


@final
class Flag:
    """A number in shared memory that one process raises and others look at."""

    def __init__(self) -> None:
        self._memory = RawArray(ctypes.c_uint64, 1)

    @property
    def count(self) -> int:
        """How often it was raised."""
        return int(self._memory[0])

    def raise_(self) -> None:
        """Count one up; one process alone may do so."""
        self._memory[0] += 1
