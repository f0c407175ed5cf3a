"""Idle and oversized connections hold up nobody else: a small server with low limits."""

import asyncio
import ssl
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

import pytest
import uvicorn

from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.server.app import serve_on, server_config
from latentarm.web.server.config import TeleopConfig, listen
from latentarm.web.server.connections import HEAD_LIMIT, ConnectionLimits

from .test_tls import made_certificate

MOST = 8
LOW = ConnectionLimits(most=MOST, head_s=0.15, body_s=0.15, stalled_s=0.15, closing_s=0.1, look_s=0.02)
PATIENT = ConnectionLimits(most=MOST, head_s=60.0, body_s=60.0, stalled_s=60.0, look_s=0.02)
WITHIN_S = 10.0
REQUEST = b"GET / HTTP/1.1\r\nHost: x\r\n\r\n"
UPGRADE = b"GET / HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: upgrade\r\n"
VERSION = b"Sec-WebSocket-Version: 13\r\n"
KEY = b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
BIG = bytes(1 << 24)


async def app(scope, receive, send):
    """Reads a body and answers; much where it is asked for ``/big``; greets WebSockets."""
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.accept"})
        while (await receive())["type"] != "websocket.disconnect":
            pass
    elif scope["type"] == "http":
        while (await receive()).get("more_body"):
            pass
        body = BIG if scope["path"] == "/big" else b"hello"
        headers = [(b"content-length", str(len(body)).encode())]
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await send({"type": "http.response.body", "body": body})


@asynccontextmanager
async def serving(limits, certificate=None, key=None):
    """Opens connections to a server in this event loop."""
    config = TeleopConfig(Spec(), port=0, certfile=certificate, keyfile=key)
    listening = listen(config)
    server = uvicorn.Server(server_config(app, config))
    server.config.lifespan = "off"
    running = asyncio.create_task(serve_on(listening, server, limits))
    visitors = Visitors(listening.getsockname()[1])
    try:
        async with asyncio.timeout(WITHIN_S):
            yield visitors
            await visitors.go()
            server.should_exit = True
            await running
    finally:
        await visitors.go()
        running.cancel()
        listening.close()


@dataclass
class Visitors:
    """Opens raw connections to a port."""

    port: int
    peers: list = field(default_factory=list)

    async def connect(self, sent=b"", **how):
        peer = Peer(*await asyncio.open_connection("127.0.0.1", self.port, **how))
        self.peers.append(peer)
        peer.writer.write(sent)
        return peer

    async def asked(self, **how):
        """The status that a good request is answered with."""
        return await (await self.connect(REQUEST, **how)).answer()

    async def go(self):
        for peer in self.peers:
            peer.writer.transport.abort()
        await asyncio.sleep(LOW.look_s)


@dataclass
class Peer:
    """A raw connection."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter

    async def said(self):
        """All that the server says until it hangs up."""
        try:
            return await self.reader.read()
        except ConnectionError:
            return b""

    async def answer(self):
        """Status of an answer; None where the server has hung up instead."""
        try:
            line = await self.reader.readline()
        except ConnectionError:
            return None
        return int(line.split()[1]) if line else None


@pytest.mark.parametrize(
    "beginning",
    [b"", b"GET", b"GET / HTTP/1.1\r\nHost: ", b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 5\r\n\r\nhe"],
    ids=["nothing", "method", "headers", "body"],
)
def test_a_request_must_be_whole_in_time(beginning):
    async def run():
        async with serving(LOW) as visitors:
            assert await (await visitors.connect(beginning)).said() == b""
            assert await visitors.asked() == 200

    asyncio.run(run())


def test_a_header_that_drips_in_has_the_same_deadline():
    async def run():
        async with serving(LOW) as visitors:
            peer = await visitors.connect(b"GET / HTTP/1.1\r\nX: ")

            async def drip():
                while True:
                    peer.writer.write(b"a")
                    await asyncio.sleep(0.01)

            dripping = asyncio.create_task(drip())
            assert await peer.said() == b""
            dripping.cancel()

    asyncio.run(run())


def test_a_connection_that_asks_again_is_kept():
    async def run():
        async with serving(LOW) as visitors:
            peer = await visitors.connect()
            for _ in range(6):
                peer.writer.write(REQUEST)
                assert await peer.answer() == 200
                await peer.reader.readuntil(b"hello")
                await asyncio.sleep(LOW.head_s / 3)

    asyncio.run(run())


def test_a_new_connection_gets_in_however_many_are_idle():
    async def run():
        async with serving(PATIENT) as visitors:
            socket = await visitors.connect(UPGRADE + VERSION + KEY)
            assert await socket.answer() == 101
            idle = [await visitors.connect(b"GET / HTTP/1.1\r\n") for _ in range(5 * MOST)]
            assert [await visitors.asked() for _ in range(3)] == [200, 200, 200]
            assert await idle[0].said() == b""
            # The oldest idle ones had to go; what is at work stays.
            idle[-1].writer.write(b"Host: x\r\n\r\n")
            assert await idle[-1].answer() == 200
            await socket.reader.readuntil(b"\r\n\r\n")
            assert not socket.reader.at_eof()

    asyncio.run(run())


@pytest.mark.parametrize(
    "head",
    [
        b"GET / HTTP/1.1\r\nX: " + b"a" * (1 << 20),
        b"GET /" + b"a" * (1 << 20),
        b"GET / HTTP/1.1\r\nX: " + b"a" * (1 << 20) + b"\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * (1 << 17) + b"\r\n",
        b"\r\n" * (1 << 19),
        b"\x16\x03\x01" * (1 << 18),
    ],
    ids=["header", "line", "whole", "many", "empty lines", "not HTTP"],
)
def test_headers_are_bounded(head):
    async def run():
        async with serving(PATIENT) as visitors:
            assert await (await visitors.connect(head)).answer() in (400, None)

    asyncio.run(run())


def test_headers_within_the_limit_are_read():
    async def run():
        async with serving(PATIENT) as visitors:
            head = b"GET / HTTP/1.1\r\nHost: x\r\nX: " + b"a" * (HEAD_LIMIT - 100) + b"\r\n\r\n"
            peer = await visitors.connect(head)
            assert await peer.answer() == 200

    asyncio.run(run())


@pytest.mark.parametrize(
    "more",
    [b"", VERSION, b"a: b\r\n" * 200, b"a: " + b"b" * 9000 + b"\r\n"],
    ids=["no version", "no key", "many headers", "a long one"],
)
def test_a_faulty_request_for_a_websocket_is_refused_at_once(more):
    async def run():
        async with serving(PATIENT) as visitors:
            assert await (await visitors.connect(UPGRADE + more + b"\r\n")).answer() in (400, 426)

    asyncio.run(run())


def test_who_takes_nothing_of_an_answer_is_dropped():
    async def run():
        async with serving(LOW) as visitors:
            peer = await visitors.connect(REQUEST.replace(b"/", b"/big", 1), limit=1 << 16)
            await asyncio.sleep(3 * LOW.stalled_s)
            assert len(await peer.said()) < len(BIG)

    asyncio.run(run())


def test_who_takes_an_answer_slowly_gets_it_all():
    async def run():
        async with serving(LOW) as visitors:
            peer = await visitors.connect(REQUEST.replace(b"/", b"/big", 1), limit=1 << 16)
            await peer.reader.readuntil(b"\r\n\r\n")
            taken = 0
            while taken < len(BIG):
                taken += len(await peer.reader.read(1 << 20))
                await asyncio.sleep(0.005)

    asyncio.run(run())


def test_half_a_tls_handshake_has_a_deadline_and_keeps_nobody_out(tmp_path):
    certificate = made_certificate(tmp_path, "localhost")
    trust = ssl.create_default_context(cafile=certificate)
    trust.check_hostname = False

    async def run():
        async with serving(LOW, certificate, tmp_path / "key.pem") as visitors:
            silent = [await visitors.connect() for _ in range(3 * MOST)]
            assert await visitors.asked(ssl=trust) == 200
            assert [await peer.said() for peer in silent] == [b""] * len(silent)

    asyncio.run(run())
