"""Pictures from devices, cameras on the network, and video files, decoded by FFmpeg (PyAV)."""

import threading
import time
from collections.abc import Iterator
from typing import Final, final

import av
import av.logging
import numpy as np
from av.container import InputContainer
from av.error import FFmpegError
from av.video.frame import VideoFrame
from av.video.stream import VideoStream

from latentarm.cameras.clock_pattern import clock_pictures
from latentarm.cameras.picture import MOST_HIGH, MOST_PER_S, MOST_WIDE, Picture, fitted
from latentarm.cameras.sharing import shared_pictures
from latentarm.cameras.sources import CameraSource, Kind
from latentarm.core.errors import UserError

DRIFT: Final = 2e-4  # the camera's clock may run faster or slower than ours by this share
_OPEN_WITHIN_S: Final = 5.0
_READ_WITHIN_S: Final = 3.0
_MOST_PIXELS: Final = 4096 * 2304
"""Larger pictures are refused: a file or a camera could ask for any amount of memory."""

_LATEST_STAMP_S: Final = 1.0
"""A device's own stamp counts if it lies this close before now: on Linux it is the monotonic clock's."""

_BEHIND_S: Final = 0.2
_MOST_WAITED_S: Final = 2.0
_SPARE: Final = 0.9

_OPTIONS: Final[dict[Kind, dict[str, str]]] = {
    "device": {"video_size": f"{MOST_WIDE}x{MOST_HIGH}", "framerate": str(MOST_PER_S)},
    "network": {
        "rtsp_transport": "tcp",
        "fflags": "nobuffer",
        "flags": "low_delay",
        "protocol_whitelist": "rtsp,rtsps,rtp,tcp,tls,udp,crypto",
    },
    # A playlist could name other files, or addresses in the network.
    "file": {"protocol_whitelist": "file"},
    "pattern": {},
}

# FFmpeg would print addresses, passwords included.
av.logging.set_level(None)


@final
class CameraError(UserError):
    """A camera cannot be opened, or gives no pictures any more. The sentence names no address."""


def open_pictures(source: CameraSource, closing: threading.Event) -> Iterator[Picture]:
    """The pictures of a camera until ``closing`` is set; a file begins again at its end.

    Those of a device come from the process that has it open, if one serves them. Raises CameraError if the
    camera cannot be opened, or has ended.
    """
    if source.kind == "device":
        yield from shared_pictures(source, closing)
    if not closing.is_set():
        yield from decoded_pictures(source, closing)


def decoded_pictures(source: CameraSource, closing: threading.Event) -> Iterator[Picture]:
    """As `open_pictures`, but opened here."""
    if source.kind == "pattern":
        yield from clock_pictures(closing)
        return
    try:
        with _opened(source) as container:
            stream = _video_of(container, source)
            pictures = _Pace(source, closing)
            while not closing.is_set():
                for packet in container.demux(stream):
                    if packet.pts is not None:
                        pictures.arrived(float(packet.pts * packet.time_base))
                    for frame in packet.decode():
                        picture = pictures.of(frame)
                        if closing.is_set():
                            return
                        if picture is not None:
                            yield picture
                if source.kind != "file":
                    raise CameraError(f"Camera {source.name} has ended.")
                if not pictures.any:
                    raise CameraError(f"Camera {source.name}: the file has no pictures.")
                container.seek(0)
                pictures.begin_again()
    except (FFmpegError, OSError, ValueError) as error:
        # Not the error's own text: it holds the address.
        reason = getattr(error, "strerror", None) or "it cannot be read"
        raise CameraError(
            f"Camera {source.name} cannot be opened: {reason}. Check what follows {source.name}=."
        ) from None


def _opened(source: CameraSource) -> InputContainer:
    # By its whole path: FFmpeg takes "a:b.mp4" for a protocol.
    return av.open(
        f"file:{source.address}" if source.kind == "file" else source.address,
        format="v4l2" if source.kind == "device" else None,
        options=_OPTIONS[source.kind],
        timeout=(_OPEN_WITHIN_S, _READ_WITHIN_S),
    )


def _video_of(container: InputContainer, source: CameraSource) -> VideoStream:
    if not container.streams.video:
        raise CameraError(f"Camera {source.name} has no video.")
    stream = container.streams.video[0]
    if stream.width * stream.height > _MOST_PIXELS:
        raise CameraError(
            f"The pictures of camera {source.name} are too large ({stream.width} by {stream.height}): 4096 by"
            " 2304 is the most."
        )
    stream.thread_count = 1  # several would each keep a picture back
    return stream


@final
class ArrivalClock:
    """The offset of a camera's clock from the local monotonic one.

    A camera stamps its pictures with its own clock, whose start is unknown. The quickest picture shows the
    offset. A picture with a larger delay, because of the network or this computer, is older by the
    difference.
    """

    def __init__(self) -> None:
        self._behind_s = self._looked_s = np.inf

    def arrived(self, stamp_s: float, now_s: float) -> None:
        """Note a packet: its stamp on the camera's clock, s, and the local time, s."""
        drifted_s = DRIFT * (now_s - self._looked_s) if np.isfinite(self._looked_s) else 0.0
        self._behind_s, self._looked_s = min(self._behind_s + drifted_s, now_s - stamp_s), now_s

    def taken_s(self, stamp_s: float, now_s: float) -> float:
        """When the picture with this stamp was taken, s on the local clock; at the latest now."""
        return min(stamp_s + self._behind_s, now_s)


@final
class _Pace:
    """Turns frames into dated pictures, no more than are sent.

    A device dates them. A picture from the network is dated by its stamp and its arrival. A file is played at
    its own pace; a picture of it is taken when it is due.
    """

    def __init__(self, source: CameraSource, closing: threading.Event) -> None:
        self._kind = source.kind
        self._name = source.name
        self._closing = closing
        self._arrivals = ArrivalClock()
        self._began_s: float | None = None
        self._next_s = self._last_s = -np.inf
        self._sent_s = -np.inf
        self.any = False

    def begin_again(self) -> None:
        self._began_s = None

    def arrived(self, stamp_s: float) -> None:
        self._arrivals.arrived(stamp_s, time.monotonic())

    def of(self, frame: VideoFrame) -> Picture | None:
        """The picture of a frame; None if it follows the last one too closely.

        Raises CameraError if it is too large, or so late that a new connection is quicker.
        """
        if frame.width * frame.height > _MOST_PIXELS:
            raise CameraError(f"The pictures of camera {self._name} have become too large.")
        self.any = True
        captured_s = self._captured_s(frame)
        if self._kind == "network" and time.monotonic() - captured_s > _MOST_WAITED_S:
            raise CameraError(f"Camera {self._name} is too far behind.")
        if captured_s - self._sent_s < _SPARE / MOST_PER_S:
            return None
        self._sent_s = captured_s
        width, height = fitted(frame.width, frame.height)
        small = frame.reformat(width=width, height=height, format="yuv420p")
        return Picture(np.asarray(small.to_ndarray(), np.uint8), captured_s)

    def _captured_s(self, frame: VideoFrame) -> float:
        now_s = time.monotonic()
        if self._kind == "file":
            return self._due_s(frame, now_s)
        if self._kind == "network":
            return now_s if frame.pts is None else self._arrivals.taken_s(frame.time, now_s)
        stamp_s = -np.inf if frame.pts is None else frame.time
        return stamp_s if now_s - _LATEST_STAMP_S < stamp_s <= now_s else now_s

    def _due_s(self, frame: VideoFrame, now_s: float) -> float:
        """Wait until a frame of a file is due, s; a late file plays on from there."""
        at_s = 0.0 if frame.pts is None else frame.time
        if self._began_s is None:
            self._began_s = max(now_s, self._next_s) - at_s
        due_s = self._began_s + at_s
        if due_s < now_s - _BEHIND_S or due_s > now_s + _READ_WITHIN_S:
            self._began_s, due_s = now_s - at_s, now_s
        # The last frame is shown as long as the one before it.
        self._next_s = due_s + min(max(0.0, due_s - self._last_s), _READ_WITHIN_S)
        self._last_s = due_s
        self._closing.wait(max(0.0, due_s - now_s))
        return due_s
