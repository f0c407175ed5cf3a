"""Access to the server: exact hosts and origins, a cookie off the loopback, strict headers."""

import asyncio
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import KW_ONLY, dataclass, field
from typing import Final, final

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect, HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from latentarm.web.server.invitations import ENTRY, INVITATION
from latentarm.web.server.invitations import answer as invitation_answer
from latentarm.web.server.keys import LIFE_S, Keys

COOKIE: Final = "latentarm"
BODY_LIMIT: Final = 1 << 16  # the longest request body, bytes
MOST_REQUESTS: Final = 64  # requests that may be in progress at once, apart from `STOP`
DRIVE: Final = "/drive"  # the only WebSocket
EXPIRED: Final = 4401  # close code of a WebSocket whose cookie has expired, from the range for applications
EXPIRED_WHY: Final = "expired"  # the reason that goes with it, a `NoticeCode`
STOP: Final = "/stop"  # needs no cookie: anyone who can reach the page may stop the arm
HEALTH: Final = "/health"  # needs no cookie either: it only says whether the server is well
_MOST_DIGITS: Final = 20
_READING: Final = ("GET", "HEAD")

_HEADERS: Final = {
    "content-security-policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self';"
        " manifest-src 'self';"
        " base-uri 'none'; form-action 'none'; frame-ancestors 'none'; require-trusted-types-for 'script'"
    ),
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), microphone=(), geolocation=(), gamepad=(self)",
}

# A redirect would still count as coming from where the link was, and a strict cookie is not sent there.
_WELCOME: Final = (
    '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>latentarm</title>'
    '<meta http-equiv="refresh" content="0; url=/"></head>'
    '<body><p><a href="/">Open the page</a></p></body></html>'
)


@final
@dataclass(eq=False)
class Gate:
    """Guards the whole application and its socket.

    It answers `STOP` itself, before anything is counted, looked up or built. The application receives only
    complete requests.
    """

    app: ASGIApp
    hosts: frozenset[str]  # exact ``Host`` headers, with the port where it is not the scheme's own
    origins: frozenset[str]  # exact ``Origin`` headers
    keys: Keys | None = None  # None admits everybody, for a server on the loopback
    _: KW_ONLY
    secure: bool = False  # whether the cookie is for TLS alone
    stop: Callable[[Headers], None]  # stops the arm; gets the request's headers
    # paths that take bodies longer than `BODY_LIMIT`, with their limits, bytes
    long_bodies: Mapping[str, int] = field(default_factory=dict)
    # makes a link for the next person; called when a link was used, and for the host's page
    invite: Callable[[], str] = lambda: ""
    _requests: int = field(default=0, init=False)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass permitted requests on and answer the others."""
        if scope["type"] == "http":
            await self._request(scope, receive, _with_headers(send))
        elif scope["type"] == "websocket":
            await self._socket(scope, receive, send)
        else:
            await self.app(scope, receive, send)

    async def _request(self, scope: Scope, receive: Receive, send: Send) -> None:
        answer = self._refusal(scope, Headers(scope=scope)) or self._own_answer(scope)
        if answer is not None:
            # Anything else on this connection, such as a body, is not awaited.
            answer.headers["connection"] = "close"
            await answer(scope, receive, send)
            return
        try:
            body = await Request(scope, receive).body()
        except ClientDisconnect:
            return
        self._requests += 1
        try:
            await self.app(scope, _once(body, receive), send)
        finally:
            self._requests -= 1

    async def _socket(self, scope: Scope, receive: Receive, send: Send) -> None:
        headers = Headers(scope=scope)
        if self._refusal(scope, headers) is not None or scope["path"] != DRIVE:
            # Before it is accepted this is an answer of 403.
            await send({"type": "websocket.close", "code": 1008})
            return
        left_s = None if self.keys is None else self.keys.opens_for(_cookie(scope))
        await self.app(scope, receive if left_s is None else _until_expired(receive, left_s), send)

    def _refusal(self, scope: Scope, headers: Headers) -> Response | None:
        if headers.getlist("host") not in [[host] for host in self.hosts]:
            return PlainTextResponse("This server is not reached by that name.", 421)
        origins = headers.getlist("origin")
        must_name_origin = scope["type"] == "websocket" or scope["method"] not in _READING
        if (origins or must_name_origin) and origins not in [[origin] for origin in self.origins]:
            return PlainTextResponse("This page may not be used from another site.", 403)
        if scope["path"] == STOP:
            return None
        if not _short(headers, self.long_bodies.get(scope["path"], BODY_LIMIT)):
            return PlainTextResponse("That is too long.", 413)
        if self._requests >= MOST_REQUESTS:
            return PlainTextResponse("The server is busy: try again.", 503)
        if self.keys is None or scope["path"] in (ENTRY, HEALTH):
            return None
        if self.keys.opens_for(_cookie(scope)) is not None:
            return None
        return PlainTextResponse("Open the link that latentarm has printed; each one works once.", 401)

    def _own_answer(self, scope: Scope) -> Response | None:
        if scope["path"] == STOP:
            if scope["method"] != "POST":
                return PlainTextResponse("Stop is a POST.", 405, headers={"allow": "POST"})
            self.stop(Headers(scope=scope))
            return Response(status_code=204)
        if scope["path"] == INVITATION:
            is_host = self.keys is not None and self.keys.is_host(_cookie(scope))
            return invitation_answer(scope["method"], is_host, self.invite)
        if self.keys is None or scope["path"] != ENTRY:
            return None
        key = HTTPConnection(scope).query_params.get("key", "")
        cookie = self.keys.redeem(key) if scope["method"] == "GET" else None
        if cookie is None:
            return PlainTextResponse("This link was used already. The newest one is in the terminal.", 403)
        answer = HTMLResponse(_WELCOME, headers={"cache-control": "no-store"})
        answer.set_cookie(
            COOKIE, cookie, max_age=LIFE_S, path="/", secure=self.secure, httponly=True, samesite="strict"
        )
        self.invite()
        return answer


def _once(body: bytes, receive: Receive) -> Receive:
    given = False

    async def receive_body_first() -> Message:
        nonlocal given
        if given:
            return await receive()
        given = True
        return {"type": "http.request", "body": body, "more_body": False}

    return receive_body_first


def _until_expired(receive: Receive, left_s: float) -> Receive:
    """A socket's messages until its cookie expires; then a disconnect with `EXPIRED`."""
    until_s = time.monotonic() + left_s

    async def receive_in_time() -> Message:
        left_s = until_s - time.monotonic()
        if left_s > 0.0:
            with suppress(TimeoutError):
                async with asyncio.timeout(left_s):
                    return await receive()
        return {"type": "websocket.disconnect", "code": EXPIRED, "reason": EXPIRED_WHY}

    return receive_in_time


def _with_headers(send: Send) -> Send:
    async def with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers[name] = value
        await send(message)

    return with_headers


def _short(headers: Headers, limit: int) -> bool:
    """Whether the declared length of a body is known and within the limit."""
    if "transfer-encoding" in headers:
        return False
    length = headers.get("content-length", "0")
    return length.isascii() and length.isdigit() and len(length) <= _MOST_DIGITS and int(length) <= limit


def _cookie(scope: Scope) -> str:
    return HTTPConnection(scope).cookies.get(COOKIE, "")
