"""Which moment the timestamps of a stream mean.

The clock of a video stream runs at 90 kHz, from a random origin that aiortc draws and tells nobody. We stamp
each picture with the moment when it was taken, so one pair of timestamp and moment dates every picture of the
stream. This is the only place that reads what aiortc keeps to itself; `tests/web/test_camera_stream.py` fails
where another version keeps it elsewhere.
"""

from fractions import Fraction
from typing import Final, final

from aiortc import RTCRtpSender

RATE: Final = 90_000
"""Steps of the clock of every video stream in a second (RFC 3551)."""

TIME_BASE: Final = Fraction(1, RATE)

_WRAP: Final = 1 << 32
_NEWEST: Final = "_RTCRtpSender__rtp_timestamp"
_SENT: Final = "_RTCRtpSender__packet_count"


@final
class RtpClock:
    """The clock of one stream.

    Args:
        sender: sends the stream. It sends each picture whole before it asks for the next one.
    """

    def __init__(self, sender: RTCRtpSender) -> None:
        self._sender = sender
        self._ticks = 0
        self._sent = 0
        self.pair: tuple[int, float] | None = None

    def stamp(self, captured_s: float) -> int:
        """The time of the next picture in steps of `TIME_BASE`: later than that of the one before.

        Args:
            captured_s: when it was taken, s.
        """
        self._note()
        self._ticks = max(self._ticks + 1, round(captured_s * RATE))
        return self._ticks

    def _note(self) -> None:
        """Once the picture that was stamped last has gone out, its timestamp says where the clock began."""
        sent = int(getattr(self._sender, _SENT))
        if sent > self._sent and self._ticks:
            self._sent = sent
            self.pair = int(getattr(self._sender, _NEWEST)) % _WRAP, self._ticks / RATE
