"""Frames of every kind count, however the bytes are cut."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode, Frame, Opcode

from latentarm.web.server.rate_limit import BURST, RATE, TOO_MANY, Allowance, FrameMeter

OPCODES = [Opcode.TEXT, Opcode.BINARY, Opcode.CONT, Opcode.PING, Opcode.PONG]
ALLOWED = int(BURST)


class Watch:
    now_s = 0.0

    def __call__(self):
        return self.now_s


def sent(opcode, size):
    """A frame as a page sends it."""
    return Frame(opcode, bytes(size), fin=opcode is not Opcode.CONT).serialize(mask=True)


def pieces(data, cuts):
    edges = [0, *sorted(cut % (len(data) + 1) for cut in cuts), len(data)]
    return [data[start:end] for start, end in pairwise(edges)]


@given(
    st.lists(st.tuples(st.sampled_from(OPCODES), st.sampled_from([0, 1, 125, 126, 70_000])), max_size=8),
    st.lists(st.integers(0, 1 << 20), max_size=20),
    st.integers(0, 8),
)
def test_only_whole_frames_within_the_allowance_pass(frames, cuts, left):
    watch = Watch()
    allowance = Allowance(watch)
    for _ in range(ALLOWED - left):
        allowance.spend()
    meter = FrameMeter(allowance)
    framed = [sent(opcode, size if opcode in OPCODES[:3] else size % 126) for opcode, size in frames]
    passed = b""
    for piece in pieces(b"".join(framed), cuts):
        more, good = meter.pass_on(piece)
        passed += more
        if not good:
            break
    assert passed == b"".join(framed[:left])
    assert good == (len(framed) <= left)


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
