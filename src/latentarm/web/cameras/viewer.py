"""One page that watches the cameras, over a WebRTC connection."""

import asyncio
import json
import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, Final, final

import aioice.ice
from aiortc import (
    MediaStreamTrack,
    RTCBundlePolicy,
    RTCConfiguration,
    RTCDataChannel,
    RTCPeerConnection,
    RTCSessionDescription,
)
from aiortc.exceptions import InvalidAccessError, InvalidStateError
from av.video.frame import VideoFrame

from latentarm.core.errors import UserError
from latentarm.core.untrusted.documents import parse_object
from latentarm.web.cameras.camera import Camera
from latentarm.web.cameras.rtp_clock import TIME_BASE, RtpClock

CONNECTED_WITHIN_S: Final = 10.0  # a page that has not connected by then is dropped, s
TELL_EVERY_S: Final = 0.2  # how often a page receives the cameras' states, s
_LONGEST_MESSAGE: Final = 200

_ADDRESSES: Final = ("a=candidate:", "a=end-of-candidates", "a=remote-candidates")


def listen_only_on(host: str) -> None:
    """Make aioice listen on this numeric address alone, in this process.

    Otherwise it listens on every address but the loopback, where most pages are served.
    """

    def own_address(use_ipv4: bool, use_ipv6: bool) -> list[str]:
        return [host]

    aioice.ice.get_host_addresses = own_address


class OfferError(UserError):
    """A page's offer is not for these cameras."""


@final
class CameraTrack(MediaStreamTrack):
    """The newest pictures of a camera for one page."""

    kind = "video"

    def __init__(self, camera: Camera) -> None:
        super().__init__()
        self._camera = camera
        self._number = -1
        self.clock: RtpClock | None = None

    @property
    def said(self) -> dict[str, Any]:
        """The camera's state, and a timestamp of the stream with its moment, ms."""
        pair = None if self.clock is None else self.clock.pair
        rtp, at_ms = (None, None) if pair is None else (pair[0], 1000.0 * pair[1])
        return {"state": self._camera.state, "rtp": rtp, "at": at_ms}

    async def recv(self) -> VideoFrame:
        self._number, picture = await self._camera.after(self._number)
        # A frame of its own: the encoder writes into it.
        frame = VideoFrame.from_ndarray(picture.planes, format="yuv420p")
        if self.clock is not None:
            frame.pts = self.clock.stamp(picture.captured_s)
            frame.time_base = TIME_BASE
        return frame


@final
class Viewer:
    """A page's view of all cameras; ``gone`` is called once when the page has gone."""

    def __init__(self, cameras: Sequence[Camera], gone: Callable[[], None]) -> None:
        self._cameras = cameras
        self._gone = gone
        # No server is asked for addresses, ours or others'.
        self._peer = RTCPeerConnection(
            RTCConfiguration(iceServers=[], bundlePolicy=RTCBundlePolicy.MAX_BUNDLE)
        )
        self._tracks: list[CameraTrack] = []
        self._channel: RTCDataChannel | None = None
        self._telling: asyncio.Task[None] | None = None
        self._closed = False

    async def answer(self, offer: str) -> str:
        """Answer a page's offer to receive one video per camera, and a data channel.

        Raises OfferError if it offers something else.
        """
        try:
            await self._peer.setRemoteDescription(RTCSessionDescription(without_candidates(offer), "offer"))
            transceivers = self._peer.getTransceivers()
            kinds = [one.kind for one in transceivers]
            if kinds != ["video"] * len(self._cameras) or self._peer.sctp is None:
                raise OfferError("The page asks for something else than the cameras.")
            for camera in self._cameras:
                track = CameraTrack(camera)
                sender = self._peer.addTrack(track)
                track.clock = RtpClock(sender)
                self._tracks.append(track)
            self._peer.on("datachannel", self._talk)
            self._peer.on("connectionstatechange", self._changed)
            await self._peer.setLocalDescription(await self._peer.createAnswer())
        # A page may send any text, and aiortc says in many ways that it is no offer.
        except (ValueError, KeyError, IndexError, AttributeError, TypeError, AssertionError) as error:
            raise OfferError("The page's offer cannot be read.") from error
        except (InvalidAccessError, InvalidStateError) as error:
            raise OfferError("The page's offer cannot be used.") from error
        for camera in self._cameras:
            camera.look()
        self._telling = asyncio.create_task(self._tell())
        return self._peer.localDescription.sdp

    async def close(self) -> None:
        if self._closed:
            return
        self._closed = True
        if self._telling is not None:
            self._telling.cancel()
            for camera in self._cameras:
                camera.look_away()
        await self._peer.close()

    def _changed(self) -> None:
        if self._peer.connectionState in ("failed", "closed", "disconnected"):
            self._gone()

    def _talk(self, channel: RTCDataChannel) -> None:
        self._channel = channel
        channel.on("message", self._heard)

    def _heard(self, message: object) -> None:
        """Answer a page's question for our time; it contains the page's own."""
        channel = self._channel
        sent_ms = asked_ms(message)
        if channel is not None and sent_ms is not None and channel.readyState == "open":
            channel.send(json.dumps({"type": "time", "sent": sent_ms, "now": 1000.0 * time.monotonic()}))

    async def _tell(self) -> None:
        began_s = time.monotonic()
        while True:
            await asyncio.sleep(TELL_EVERY_S)
            if self._channel is None or self._channel.readyState != "open":
                if time.monotonic() - began_s > CONNECTED_WITHIN_S:
                    self._gone()
                    return
                continue
            # A page that does not read gets fewer messages.
            if self._channel.bufferedAmount == 0:
                said = [track.said for track in self._tracks]
                with suppress(InvalidStateError):
                    self._channel.send(json.dumps({"type": "cameras", "cameras": said}))


def asked_ms(message: object) -> float | None:
    """The page's own time in a question for ours, ms; None for another message."""
    if not isinstance(message, str) or len(message) > _LONGEST_MESSAGE:
        return None
    try:
        found = parse_object(message, "a message of the page")
    except UserError:
        return None
    sent = found.get("sent") if found.get("type") == "time" else None
    if isinstance(sent, bool) or not isinstance(sent, int | float) or not math.isfinite(sent):
        return None
    return float(sent)


def without_candidates(offer: str) -> str:
    """An offer without the page's addresses: we send nothing to where a stranger says."""
    return "".join(f"{line}\r\n" for line in offer.splitlines() if not line.startswith(_ADDRESSES))
