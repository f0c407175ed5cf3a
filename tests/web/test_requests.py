"""Requests of every kind to the whole server: none of them is its fault, and none keeps it from answering."""

import random
import socket

import pytest

METHODS = ("GET", "POST", "HEAD", "PUT", "DELETE", "OPTIONS", "TRACE", "PROPFIND", "get", "X")
PLACES = (
    "/",
    "/mesh/",
    "/static/",
    "/scene.json",
    "/stop",
    "/drive",
    "/teach",
    "/personalise",
    "/static/0/layout/page.css",
    "*",
    "//",
    "/../",
)
PIECES = (
    "%00",
    "%ff",
    "%1b",
    "%0a",
    "%2f",
    "..",
    "/",
    "\\",
    "9" * 5000,
    "é",
    "?",
    "&",
    "=",
    "#",
    "%zz",
    ";",
    "@",
)
HEADERS = (
    "Content-Length: 5",
    "Content-Length: -1",
    "Content-Length: 99999999999999999999999",
    "Transfer-Encoding: chunked",
    "Upgrade: websocket",
    "Connection: upgrade",
    "Sec-WebSocket-Key: x",
    "Sec-WebSocket-Version: 99",
    "Cookie: =;;",
    "Range: bytes=9-1,a",
    "Accept: \xff",
    'If-None-Match: "',
    "X-Forwarded-Prefix: \x1b[2J",
)


def request(rng: random.Random, host: str) -> bytes:
    """One request, mostly wrong in some way."""
    path = rng.choice(PLACES) + "".join(rng.choices(PIECES, k=rng.randrange(4)))
    lines = [f"{rng.choice(METHODS)} {path} HTTP/{rng.choice(('1.1', '1.1', '1.0', '2.0'))}", f"Host: {host}"]
    lines += rng.sample(HEADERS, rng.randrange(4))
    return ("\r\n".join(lines) + "\r\n\r\n" + rng.choice(("", "hello"))).encode("latin-1")


def status(port: int, sent: bytes) -> int | None:
    """What a request is answered with; None where the server hangs up, or waits for the rest of it."""
    with socket.create_connection(("127.0.0.1", port), timeout=0.5) as peer:
        peer.sendall(sent)
        try:
            line = peer.recv(64)
        except (TimeoutError, ConnectionError):
            return None
    return int(line.split()[1]) if line else None


@pytest.mark.parametrize("seed", range(3))
def test_no_request_is_answered_as_a_fault_of_the_server(site, seed):
    rng = random.Random(seed)  # noqa: S311 - nothing secret
    host = f"127.0.0.1:{site.port}"
    for _ in range(60):
        sent = request(rng, host)
        found = status(site.port, sent)
        assert found is None or found < 500, sent
    stop = f"POST /stop HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Length: 0\r\n\r\n"
    assert status(site.port, stop.encode()) == 204
