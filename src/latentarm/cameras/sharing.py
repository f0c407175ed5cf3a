"""A device that one process has open, for other processes of the same user: a device opens only once.

The process that has it open serves its pictures at a socket in a folder of the user's own; others that want
the device ask there first.
"""

import hashlib
import os
import struct
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from multiprocessing.connection import Client, Connection, Listener
from pathlib import Path
from typing import Final, final

import numpy as np

from latentarm.cameras.picture import MOST_HIGH, MOST_WIDE, Picture
from latentarm.cameras.sources import CameraSource

_HEADER: Final = struct.Struct("<dI")  # when a picture was taken, s, and its width
_LONGEST: Final = _HEADER.size + MOST_WIDE * MOST_HIGH * 3 // 2
_LOOK_S: Final = 0.01
_SILENT_S: Final = 3.0


@final
class SharedPictures:
    """Serves the newest picture of a device, which ``newest`` returns, until `end`."""

    def __init__(self, source: CameraSource, newest: Callable[[], Picture | None]) -> None:
        self._newest = newest
        self._ended = threading.Event()
        path = _socket_of(source)
        path.unlink(missing_ok=True)  # of a process that was killed
        self._listener = Listener(str(path), family="AF_UNIX")
        threading.Thread(target=self._accept, name=f"shared {source.name}", daemon=True).start()

    def end(self) -> None:
        """Serve no more."""
        self._ended.set()
        self._listener.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                client = self._listener.accept()
                threading.Thread(target=self._serve, args=[client], daemon=True).start()

    def _serve(self, client: Connection) -> None:
        sent: Picture | None = None
        with suppress(OSError), client:
            while not self._ended.wait(_LOOK_S):
                picture = self._newest()
                if picture is not None and picture is not sent:
                    header = _HEADER.pack(picture.captured_s, picture.planes.shape[1])
                    client.send_bytes(header + picture.planes.tobytes())
                    sent = picture


def shared_pictures(source: CameraSource, closing: threading.Event) -> Iterator[Picture]:
    """Pictures of a device that another process has open; none where no process has."""
    with suppress(OSError, EOFError, ValueError), Client(str(_socket_of(source)), "AF_UNIX") as server:
        heard_s = time.monotonic()
        while not closing.is_set() and time.monotonic() - heard_s < _SILENT_S:
            if server.poll(_LOOK_S):
                message, heard_s = server.recv_bytes(_LONGEST), time.monotonic()
                captured_s, width = _HEADER.unpack_from(message)
                planes = np.frombuffer(message, np.uint8, offset=_HEADER.size).reshape(-1, width)
                yield Picture(planes, captured_s)


def _socket_of(source: CameraSource) -> Path:
    folder = Path(os.environ.get("XDG_RUNTIME_DIR") or tempfile.gettempdir()) / f"latentarm-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if status.st_uid != os.getuid() or status.st_mode & 0o077:
        raise OSError(f"{folder} belongs to somebody else")
    device = os.path.realpath(source.address)  # front and /dev/v4l/by-id/... may be one
    return folder / hashlib.sha256(device.encode()).hexdigest()[:16]
