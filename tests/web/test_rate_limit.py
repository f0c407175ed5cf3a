"""Frames of every kind count, however the bytes are cut."""

import asyncio
from itertools import pairwise
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from uvicorn.config import Config
from uvicorn.server import ServerState
from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode, Frame, Opcode

from latentarm.web.server.rate_limit import BURST, RATE, TOO_MANY, Allowance, MeteredSocket

OPCODES = [Opcode.TEXT, Opcode.BINARY, Opcode.PING, Opcode.PONG]
ALLOWED = int(BURST)
REQUEST = (
    b"GET /drive HTTP/1.1\r\nHost: arm.local\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)


class Watch:
    now_s = 0.0

    def __call__(self):
        return self.now_s


def sent(opcode, size):
    """A frame as a page sends it."""
    return Frame(opcode, bytes(size)).serialize(mask=True)


def pieces(data, cuts):
    edges = [0, *sorted(cut % (len(data) + 1) for cut in cuts), len(data)]
    return [data[start:end] for start, end in pairwise(edges)]


@given(
    st.lists(st.tuples(st.sampled_from(OPCODES), st.sampled_from([0, 1, 125])), max_size=8),
    st.lists(st.integers(0, 1 << 20), max_size=20),
    st.integers(0, 8),
)
def test_only_frames_within_the_allowance_count_however_they_are_cut(frames, cuts, left):
    framed = [sent(opcode, size) for opcode, size in frames]
    passed, code = asyncio.run(received(pieces(b"".join(framed), cuts), left))
    assert passed == min(len(framed), left)
    assert code == (TOO_MANY if len(framed) > left else None)


async def received(pieces, left):
    """How many frames a socket with so much left takes, and the code with which it is closed."""
    taken, written = [], []

    async def app(scope, receive, send):
        await receive()
        await send({"type": "websocket.accept"})
        while (await receive())["type"] != "websocket.disconnect":
            pass

    config = Config(app, ws_per_message_deflate=False, log_config=None)
    config.load()
    socket = MeteredSocket(config, ServerState(), {})
    socket.connection_made(
        SimpleNamespace(
            get_extra_info=lambda name: None, write=written.append, close=lambda: None,
            pause_reading=lambda: None, resume_reading=lambda: None, is_closing=lambda: False,
        )
    )  # fmt: skip
    socket.data_received(REQUEST)
    await asyncio.sleep(0)
    socket._allowance._left = float(left)
    socket._allowance._now_s = lambda at_s=socket._allowance._at_s: at_s
    take = socket._take
    socket._take = lambda frame: (taken.append(frame), take(frame))
    for piece in pieces:
        socket.data_received(piece)
    socket.connection_lost(None)
    await asyncio.gather(*socket.tasks)
    closed = socket.conn.close_sent
    return len(taken), closed and closed.code


def test_an_allowance_fills_up_again():
    watch = Watch()
    allowance = Allowance(watch)
    assert [allowance.spend() for _ in range(ALLOWED + 1)] == [True] * ALLOWED + [False]
    watch.now_s = 3.0 / RATE
    assert [allowance.spend() for _ in range(4)] == [True, True, True, False]


def talk_until_closed(socket, flood):
    for _ in range(3 * ALLOWED):
        flood(socket)
    while True:
        socket.recv(timeout=5)


@pytest.mark.parametrize(
    "flood",
    [
        lambda socket: socket.ping(),
        lambda socket: socket.pong(),
        lambda socket: socket.send(iter([""] * 400)),
    ],
    ids=["pings", "pongs", "fragments"],
)
def test_a_flood_that_the_application_never_sees_ends_the_connection(site, flood):
    with site.raw() as socket:
        socket.send('{"type": "hello", "version": 1}')
        with pytest.raises(ConnectionClosed) as closed:
            talk_until_closed(socket, flood)
        # A page that is still sending may find its line cut before it has read why.
        assert closed.value.rcvd is None or closed.value.rcvd.code in (TOO_MANY, CloseCode.PROTOCOL_ERROR)
    with site.page() as page:
        assert page.wait(lambda state: state["phase"] == "disengaged")
