"""Behind a proxy that ends TLS: one public address, and cookies that survive a restart."""

import asyncio
import json
import signal
import socket
import ssl
import subprocess
import sys
from collections.abc import Generator
from contextlib import contextmanager
from http.client import HTTPSConnection
from pathlib import Path

import pytest
from websockets.asyncio.client import connect
from websockets.typing import Origin

from latentarm.core.errors import UserError
from latentarm.web.arm_process.drive_setup import Spec
from latentarm.web.server.config import TeleopConfig
from latentarm.web.server.keys import LIFE_S, Keys

from .test_tls import HELLO, made_certificate

PROXY = Path(__file__).parents[1] / "stand_ins" / "tls_proxy.py"


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@contextmanager
def proxy(certificate: Path, port: int, behind: int) -> Generator[None]:
    words = [certificate, certificate.parent / "key.pem", port, behind]
    command = [sys.executable, PROXY, *map(str, words)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.readline()
        try:
            yield
        finally:
            process.kill()


@contextmanager
def teleop(out: Path, port: int, public: str) -> Generator[tuple[str, subprocess.Popen[str]]]:
    words = ["--port", str(port), "--public-url", public, "--out", str(out), "--json"]
    command = [sys.executable, "-m", "latentarm", "teleop", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            said = server.stdout.readline()
            yield json.loads(said)["address"], server
        finally:
            server.send_signal(signal.SIGKILL)


def test_a_person_comes_back_after_the_server_was_killed(tmp_path: Path) -> None:
    certificate = made_certificate(tmp_path, "localhost")
    trust = ssl.create_default_context(cafile=certificate)
    outer, inner = free_port(), free_port()
    public = f"https://localhost:{outer}"

    def ask(path: str, cookie: str = "") -> tuple[int, str]:
        line = HTTPSConnection("localhost", outer, context=trust, timeout=10)
        line.request("GET", path, headers={"cookie": cookie} if cookie else {})
        answer = line.getresponse()
        answer.read()
        line.close()
        return answer.status, answer.headers["set-cookie"] or ""

    async def welcomed(cookie: str) -> None:
        address = f"wss://localhost:{outer}/drive"
        headers = {"Cookie": cookie}
        async with connect(address, origin=Origin(public), ssl=trust, additional_headers=headers) as drive:
            await drive.send(HELLO)
            assert json.loads(await drive.recv())["type"] == "welcome"

    out = tmp_path / "out"
    with proxy(certificate, outer, inner):
        with teleop(out, inner, public) as (link, _):
            assert link.startswith(f"{public}/enter?key=")
            assert ask("/")[0] == 401
            status, given = ask(link.removeprefix(public))
            assert status == 200
            assert {"Secure", "HttpOnly", "SameSite=strict"} <= set(given.split("; "))
            cookie = given.split("; ")[0]
            asyncio.run(welcomed(cookie))
        assert cookie.split("=")[1] not in (out / ".teleop-cookies.json").read_text()
        with teleop(out, inner, public) as (_, _):
            assert ask("/")[0] == 401
            asyncio.run(welcomed(cookie))


@pytest.mark.parametrize(
    ("public", "origins"),
    [
        ("https://Arm.example", ["https://arm.example"]),
        ("https://arm.example:443", ["https://arm.example"]),
        ("https://[2001:db8::1]:8443", ["https://[2001:db8::1]:8443"]),
    ],
)
def test_the_public_address_is_the_only_one(public: str, origins: list[str]) -> None:
    config = TeleopConfig(Spec(None), public_url=public)
    assert config.origins(8460) == origins
    assert config.encrypted
    assert not config.private


@pytest.mark.parametrize(
    "public", ["arm.example", "https://arm.example/", "ftp://arm.example", "https://a b"]
)
def test_another_public_address_is_refused(public: str) -> None:
    with pytest.raises(UserError, match="without a path"):
        TeleopConfig(Spec(None), public_url=public)


class TestCookiesOnDisk:
    @pytest.fixture
    def store(self, tmp_path: Path) -> Path:
        return tmp_path / "cookies.json"

    def entered(self, keys: Keys) -> str:
        cookie = keys.redeem(keys.new_link())
        assert cookie is not None
        return cookie

    def test_live_ones_come_back_and_the_host_stays_the_host(self, store: Path) -> None:
        clock = [1000.0]
        before = Keys(lambda: clock[0], store)
        host, guest = self.entered(before), self.entered(before)
        clock[0] += LIFE_S - 60
        after = Keys(lambda: clock[0], store)
        assert [after.opens_for(one) for one in (host, guest)] == [60, 60]
        assert [after.is_host(one) for one in (host, guest)] == [True, False]
        clock[0] += 60
        assert after.opens_for(host) is None

    def test_a_clock_that_was_set_back_makes_none_valid_for_longer(self, store: Path) -> None:
        cookie = self.entered(Keys(lambda: 1000.0, store))
        assert Keys(lambda: 900.0, store).opens_for(cookie) is None

    def test_the_link_that_is_printed_after_a_restart_makes_a_host(self, store: Path) -> None:
        self.entered(Keys(store=store))
        after = Keys(store=store)
        assert after.is_host(self.entered(after))

    @pytest.mark.parametrize("content", ["", "{", '{"cookies": {"a": 1}}', '{"cookies": []}'])
    def test_a_damaged_file_lets_nobody_in(self, store: Path, content: str) -> None:
        store.write_text(content)
        keys = Keys(store=store)
        assert keys.opens_for("") is None
        assert keys.opens_for(self.entered(keys)) is not None
