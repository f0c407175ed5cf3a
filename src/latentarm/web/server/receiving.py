"""Receive a page's messages, or learn why the page is refused."""

from typing import Final

from starlette.websockets import WebSocket, WebSocketDisconnect

from latentarm.web.protocol.page_messages import FRAME_LIMIT, ClientMessage, parse_message
from latentarm.web.server.rate_limit import TOO_MANY
from latentarm.web.server.security import EXPIRED

_PROTOCOL_BROKEN: Final = (1002, 1003, 1007, TOO_MANY, 1009)
"""Close codes of uvicorn: no frame, no text, too many frames, or one far too long."""


class ViolationError(Exception):
    """A page has sent something forbidden."""


class ExpiredError(Exception):
    """A page's cookie has expired."""


async def receive(socket: WebSocket) -> ClientMessage:
    """The next message.

    Raises ViolationError if it is invalid, or there are too many. Raises ExpiredError if the page's cookie
    has expired. Raises WebSocketDisconnect if the page has gone.
    """
    event = await socket.receive()
    if event["type"] == "websocket.disconnect":
        if event.get("code") in _PROTOCOL_BROKEN:
            raise ViolationError
        if event.get("code") == EXPIRED:
            raise ExpiredError
        raise WebSocketDisconnect
    text = event.get("text")
    if text is None or len(text) > FRAME_LIMIT or len(text.encode()) > FRAME_LIMIT:
        raise ViolationError
    try:
        return parse_message(text)
    except ValueError as error:
        raise ViolationError from error
