"""Off the loopback: TLS, a link that works once, and a cookie that only this site over TLS is sent."""

import asyncio
import json
import shutil
import signal
import socket
import ssl
import subprocess
import sys
from dataclasses import dataclass
from http.client import HTTPSConnection
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

HELLO = '{"type": "hello", "version": 1}'


@dataclass
class Secured:
    """A running server, and what a browser that trusts its certificate knows."""

    link: str
    trust: ssl.SSLContext

    @property
    def origin(self) -> str:
        return self.link.split("/enter")[0]

    def ask(self, path: str, cookie: str = "") -> tuple[int, str | None]:
        """Status of an answer, and the cookie that it sets."""
        line = HTTPSConnection(urlsplit(self.link).netloc, context=self.trust, timeout=10)
        line.request("GET", path, headers={"cookie": cookie} if cookie else {})
        answer = line.getresponse()
        answer.read()
        line.close()
        return answer.status, answer.headers["set-cookie"]


@pytest.fixture(scope="module")
def secured(tmp_path_factory):
    """`latentarm teleop` on this machine's own name, with a certificate that was just made."""
    folder = tmp_path_factory.mktemp("tls")
    name = own_name()
    certificate = made_certificate(folder, name)
    words = ["--host", name, "--port", "0", "--out", folder, "--json"]
    words += ["--certfile", certificate, "--keyfile", folder / "key.pem"]
    command = [sys.executable, "-m", "latentarm", "teleop", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as server:
        try:
            said = server.stdout.readline()
            assert said, server.stderr.read()
            yield Secured(json.loads(said)["address"], ssl.create_default_context(cafile=certificate))
        finally:
            server.send_signal(signal.SIGINT)


def own_name() -> str:
    name = socket.gethostname()
    try:
        socket.getaddrinfo(name, 0)
    except OSError:
        pytest.skip("This machine does not know its own name.")
    if name == "localhost":
        pytest.skip("This machine has no name but localhost, which needs no link.")
    return name


def made_certificate(folder: Path, name: str) -> Path:
    if shutil.which("openssl") is None:
        pytest.skip("No openssl is installed.")
    made = ["-keyout", folder / "key.pem", "-out", folder / "certificate.pem"]
    named = ["-subj", f"/CN={name}", "-addext", f"subjectAltName=DNS:{name}"]
    kind = ["-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2"]
    subprocess.run(["openssl", "req", *kind, *made, *named], check=True, capture_output=True)
    return folder / "certificate.pem"


def test_the_page_is_reached_through_the_link_once(secured):
    assert secured.link.startswith("https://")
    assert secured.ask("/") == (401, None)
    path = secured.link.removeprefix(secured.origin)
    status, cookie = secured.ask(path)
    assert status == 200
    name, *words = cookie.split("; ")
    assert {"Secure", "HttpOnly", "SameSite=strict"} <= set(words)
    assert secured.ask("/scene.json", name) == (200, None)
    assert secured.ask(path) == (403, None)

    asyncio.run(is_driven_with_the_cookie_only(secured, name))


async def is_driven_with_the_cookie_only(secured, cookie):
    # Not the client with threads: OpenSSL may lose what one sends while another reads the same connection.
    address = secured.origin.replace("https", "wss", 1) + "/drive"
    known = {"origin": secured.origin, "ssl": secured.trust, "compression": None}
    async with connect(address, additional_headers={"Cookie": cookie}, **known) as drive:
        await drive.send(HELLO)
        assert json.loads(await drive.recv())["type"] == "welcome"
    with pytest.raises(InvalidStatus):
        await connect(address, **known)


def test_nobody_is_answered_without_tls(secured):
    where = urlsplit(secured.link)
    with socket.create_connection((where.hostname, where.port), timeout=5) as line:
        line.sendall(f"GET / HTTP/1.1\r\nHost: {where.netloc}\r\n\r\n".encode())
        assert not line.recv(1000).startswith(b"HTTP/1.1 200")
