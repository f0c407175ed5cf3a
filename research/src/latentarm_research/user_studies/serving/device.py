"""The check of a participant's device: its results, and the sentences where it falls short."""

import asyncio
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Annotated, Final, final

from pydantic import Field
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from latentarm.web.protocol.notice import Message
from latentarm.web.words.catalogue import Words
from latentarm_research.user_studies.device_limits import DeviceLimits, InputKind

ECHO_S: Final = 20.0  # the page needs 10 s
_ECHO_LIMIT: Final = 8  # characters of a message

_NAMES: Final[Mapping[InputKind, str]] = {
    "mouse": "study.device.mouse",
    "touch": "study.device.touch",
    "pen": "study.device.pen",
    "keyboard": "study.device.keyboard",
    "gamepad": "study.device.gamepad",
}
_Milliseconds = Annotated[float, Field(ge=0.0, le=60_000.0)]
_Pixels = Annotated[int, Field(ge=0, le=100_000)]


@final
class Device(Message):
    """A participant's browser, window, input devices and connection."""

    browser: Annotated[str, Field(max_length=40, pattern=r"^[A-Za-z]* ?\d*$")]  # such as Firefox 140
    webgl: bool  # WebGL 2 works
    width_px: _Pixels  # of the window, CSS pixels
    height_px: _Pixels
    inputs: Annotated[tuple[InputKind, ...], Field(max_length=5)]  # those that they have used on the page
    round_trip_ms: _Milliseconds | None  # median over 10 s of messages; None where none came back
    jitter_ms: _Milliseconds | None  # of the 95th percentile above it


def shortfalls(limits: DeviceLimits, found: Device, words: Words) -> Iterator[str]:
    """A sentence for each limit that the device does not meet, with what may help."""
    if not found.webgl:
        yield words.say("study.device.webgl")
    if found.width_px < limits.width_px or found.height_px < limits.height_px:
        yield words.say("study.device.window", {"width": limits.width_px, "height": limits.height_px})
    if limits.needs and not set(limits.needs) & set(found.inputs):
        yield words.say(
            "study.device.input", {"names": ", ".join(words.say(_NAMES[one]) for one in limits.needs)}
        )
    if found.round_trip_ms is None or found.jitter_ms is None:
        yield words.say("study.device.unconnected")
    elif found.round_trip_ms > limits.round_trip_ms:
        yield words.say("study.device.slow", {"ms": round(found.round_trip_ms)})
    elif found.jitter_ms > limits.jitter_ms:
        yield words.say("study.device.unsteady")


async def echo(scope: Scope, receive: Receive, send: Send) -> None:
    """Send back what the page sends over the socket of a drive, for `ECHO_S` at most."""
    socket = WebSocket(scope, receive, send)
    await socket.accept()
    with suppress(TimeoutError, WebSocketDisconnect, RuntimeError, OSError):
        async with asyncio.timeout(ECHO_S):
            while True:
                event = await socket.receive()
                text = event.get("text")
                if text is None or len(text) > _ECHO_LIMIT:
                    break
                await socket.send_text(text)
        await socket.close()
