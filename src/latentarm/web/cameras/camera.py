"""One camera at work: a thread keeps its newest picture, and reopens it when it is lost."""

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from typing import Final, Literal, final

import numpy as np
from numpy.typing import NDArray

from latentarm.cameras.picture import Picture
from latentarm.cameras.sources import CameraSource
from latentarm.core.errors import UserError

CameraState = Literal["opening", "live", "dark", "lost"]
"""Being opened; visible; visible, but too dark; without a picture for `LOST_AFTER_S`."""

LOST_AFTER_S: Final = 1.0

_OPENING_S: Final = 8.0
_RETRY_S: Final = 1.0
_END_WITHIN_S: Final = 1.0

OpenPictures = Callable[[CameraSource, threading.Event], Iterator[Picture]]

DARK: Final = 0.08
LIGHT: Final = 0.11
"""Mean brightness under which it is too dark, and from which it is light again, as shares of white."""

_BLACK, _WHITE = 16.0, 235.0
_EVERY: Final = 8


def is_dark(planes: NDArray[np.uint8], was: bool) -> bool:
    """True if a picture (see `Picture.planes`) is too dark, by every 64th pixel; ``was``: the last result."""
    rows = 2 * planes.shape[0] // 3
    mean = float(planes[:rows:_EVERY, ::_EVERY].mean(dtype=np.float64))
    return (mean - _BLACK) / (_WHITE - _BLACK) < (LIGHT if was else DARK)


@final
class Camera:
    """A camera that is open while somebody looks at it; ``loop`` waits for its pictures."""

    def __init__(
        self, source: CameraSource, open_pictures: OpenPictures, loop: asyncio.AbstractEventLoop
    ) -> None:
        self.source = source
        self._open_pictures = open_pictures
        self._loop = loop
        self._lookers = 0
        self._closing = threading.Event()
        self._thread: threading.Thread | None = None
        self._dark = False
        self._newest: tuple[int, Picture] | None = None
        self._shown_s = self._opened_s = -_OPENING_S
        self._seen = False
        self._come = asyncio.Event()

    @property
    def state(self) -> CameraState:
        now_s = time.monotonic()
        if now_s - self._shown_s <= LOST_AFTER_S:
            return "dark" if self._dark else "live"
        return "opening" if not self._seen and now_s - self._opened_s < _OPENING_S else "lost"

    @property
    def age_s(self) -> float | None:
        """How long ago the newest picture came, s; None before the first and while nobody looks."""
        return time.monotonic() - self._shown_s if self._lookers and self._seen else None

    def look(self) -> None:
        """Add a viewer: the first one opens the camera."""
        self._lookers += 1
        if self._lookers > 1:
            return
        self._closing = threading.Event()
        self._newest, self._seen, self._opened_s = None, False, time.monotonic()
        self._thread = threading.Thread(
            target=self._work, args=[self._closing], name=f"camera {self.source.name}", daemon=True
        )
        self._thread.start()

    def look_away(self) -> None:
        """Remove a viewer: the last one closes the camera, soon."""
        self._lookers -= 1
        if self._lookers == 0:
            self._closing.set()

    def end(self) -> None:
        """Close it and wait shortly for that."""
        self._closing.set()
        if self._thread is not None:
            self._thread.join(_END_WITHIN_S)

    async def after(self, number: int) -> tuple[int, Picture]:
        """Wait for a picture with a higher number; returns the newest with its number, from 0 on."""
        while self._newest is None or self._newest[0] <= number:
            self._come.clear()
            await self._come.wait()
        return self._newest

    def _work(self, closing: threading.Event) -> None:
        number = 0
        while not closing.is_set():
            try:
                for picture in self._open_pictures(self.source, closing):
                    number += 1
                    self._dark = is_dark(picture.planes, self._dark)
                    self._loop.call_soon_threadsafe(self._show, closing, number, picture)
            except UserError:
                pass  # the page says that there is no picture
            except RuntimeError:
                return  # the loop has ended, and with it this process
            closing.wait(_RETRY_S)

    def _show(self, closing: threading.Event, number: int, picture: Picture) -> None:
        if closing.is_set():
            return
        self._newest, self._seen = (number, picture), True
        self._shown_s = time.monotonic()
        self._come.set()


def check_camera(source: CameraSource, open_pictures: OpenPictures) -> str | None:
    """Open a camera for one picture; returns why none came, or None if one did."""
    closing = threading.Event()
    pictures = open_pictures(source, closing)
    try:
        next(pictures)
    except UserError as error:
        return str(error)
    except StopIteration:
        return f"Camera {source.name} gives no picture."
    finally:
        closing.set()
        close = getattr(pictures, "close", None)
        if close is not None:
            close()
    return None
