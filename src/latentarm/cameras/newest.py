"""The newest picture of a camera, kept by a thread that opens it again when it is lost."""

import threading
from collections.abc import Iterator
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from latentarm.cameras.decoding import decoded_pictures
from latentarm.cameras.picture import Picture
from latentarm.cameras.sharing import SharedPictures, shared_pictures
from latentarm.cameras.sources import CameraSource
from latentarm.core.errors import UserError

_OPENED_WITHIN_S: Final = 15.0
_RETRY_S: Final = 1.0
_END_WITHIN_S: Final = 1.0


@final
class NewestPicture:
    """Begins to read a camera at once, until ``closing`` is set."""

    def __init__(self, source: CameraSource, closing: threading.Event) -> None:
        self.picture: Picture | None = None
        self._source, self._closing = source, closing
        self._failed = ""
        self._tried = threading.Event()
        self._thread = threading.Thread(target=self._work, name=f"camera {source.name}", daemon=True)
        self._thread.start()

    def first(self) -> Picture:
        """Wait for a picture; raises UserError where none comes."""
        self._tried.wait(_OPENED_WITHIN_S)
        if self.picture is None:
            raise UserError(self._failed or f"Camera {self._source.name} gives no picture in time.")
        return self.picture

    def end(self) -> None:
        """Wait shortly for the camera to close, after ``closing`` is set."""
        self._thread.join(_END_WITHIN_S)

    def _work(self) -> None:
        while not self._closing.is_set():
            try:
                for picture in self._pictures():
                    self.picture = picture
                    self._tried.set()
            except (UserError, OSError) as error:
                self._failed = str(error)
                self._tried.set()
            self._closing.wait(_RETRY_S)

    def _pictures(self) -> Iterator[Picture]:
        if self._source.kind != "device":
            yield from decoded_pictures(self._source, self._closing)
            return
        yield from shared_pictures(self._source, self._closing)
        shared = SharedPictures(self._source, lambda: self.picture)
        try:
            yield from decoded_pictures(self._source, self._closing)
        finally:
            shared.end()


def brightness_of(picture: Picture) -> NDArray[np.uint8]:
    """The picture in grey, (H, W)."""
    return picture.planes[: 2 * picture.planes.shape[0] // 3]
