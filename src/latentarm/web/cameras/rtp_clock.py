"""The moments behind the timestamps of a stream.

The clock of a video stream runs at 90 kHz, from a random origin that aiortc keeps private. We stamp each
picture with the moment when it was taken, so one pair of timestamp and moment dates every picture of the
stream. Only this module reads aiortc's private state; `tests/web/test_camera_stream.py` fails if another
version keeps it elsewhere.
"""

from fractions import Fraction
from typing import Final, final

from aiortc import RTCRtpSender

RATE: Final = 90_000  # ticks per second of every video stream's clock (RFC 3551)
TIME_BASE: Final = Fraction(1, RATE)

_WRAP: Final = 1 << 32
_NEWEST: Final = "_RTCRtpSender__rtp_timestamp"
_SENT: Final = "_RTCRtpSender__packet_count"


@final
class RtpClock:
    """The clock of one stream, whose sender sends each picture whole before it asks for the next one."""

    def __init__(self, sender: RTCRtpSender) -> None:
        self._sender = sender
        self._ticks = 0
        self._sent = 0
        self.pair: tuple[int, float] | None = None

    def stamp(self, captured_s: float) -> int:
        """The time of the next picture, taken at ``captured_s``, in steps of `TIME_BASE`; it always grows."""
        self._note()
        self._ticks = max(self._ticks + 1, round(captured_s * RATE))
        return self._ticks

    def _note(self) -> None:
        """Once the last stamped picture has gone out, its timestamp gives the clock's origin."""
        sent = int(getattr(self._sender, _SENT))
        if sent > self._sent and self._ticks:
            self._sent = sent
            self.pair = int(getattr(self._sender, _NEWEST)) % _WRAP, self._ticks / RATE
