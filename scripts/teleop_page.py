"""For the scripts that look at the teleoperation page: its server, and a Chromium in front of it."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SOFTWARE_GL = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
START_S = 60.0
AT_START = "way_back.at_start"


@dataclass(frozen=True)
class Site:
    """A running `latentarm teleop`.

    Attributes:
        address: of the page.
        pid: of the web server's process.
    """

    address: str
    pid: int


@contextmanager
def served(run: Path, out: Path | None = None, options: Sequence[str] = ()) -> Iterator[Site]:
    """`latentarm teleop RUN` as long as the block lasts.

    Args:
        run: a trained run.
        out: keeps what is recorded.
        options: further words of the command.
    """
    with tempfile.TemporaryDirectory() as folder:
        said = Path(folder) / "said"
        command = [sys.executable, "-m", "latentarm", "teleop", str(run), *options]
        command += ["--port", "0", "--out", str(out or folder)]
        with said.open("w") as file:
            server = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT)
        try:
            yield Site(_address(server, said), server.pid)
        finally:
            server.send_signal(signal.SIGINT)
            server.wait(20)


def _address(server: "subprocess.Popen[bytes]", said: Path) -> str:
    end_s = time.monotonic() + START_S
    while time.monotonic() < end_s and server.poll() is None:
        found = re.search(r"http://[\d.]+:\d+", said.read_text())
        if found and _answers(found.group()):
            return found.group()
        time.sleep(0.1)
    raise SystemExit(said.read_text() or "The server did not start.")


def _answers(address: str) -> bool:
    host, port = address.removeprefix("http://").split(":")
    try:
        with socket.create_connection((host, int(port)), timeout=1.0):
            return True
    except OSError:
        return False


@contextmanager
def chromium() -> Iterator[Browser]:
    """A Chromium of this machine, without a window, that draws without a graphics processor."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=find_chromium(), args=[*SOFTWARE_GL, *sandboxed()]
        )
        yield browser
        browser.close()


def find_chromium() -> str:
    """The Chromium of this machine.

    Raises:
        SystemExit: there is none.
    """
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        raise SystemExit(f"No Chromium is installed: looked for {', '.join(NAMES)}.")
    return found


def sandboxed() -> tuple[str, ...]:
    """Arguments without which Chromium does not run here: as root, as in containers, it has no sandbox."""
    return ("--no-sandbox",) if os.getuid() == 0 else ()


def drive_back(page: Page) -> None:
    """Have the arm driven back to its start, and stop it there."""
    why = page.locator("#way-back-why")
    at_start = json.loads(page.locator("#words").text_content() or "")[AT_START]
    for _ in range(10):
        if why.text_content() == at_start:
            break
        enable(page)
        page.locator("#way-back").dispatch_event("click")
        page.wait_for_timeout(500)
        for _ in range(40):
            if page.locator("#status[data-phase=moving]").count() == 0:
                break
            page.wait_for_timeout(500)
    page.keyboard.press("Escape")
    page.wait_for_timeout(500)


def enable(page: Page) -> None:
    """Press Enable until the arm is enabled: a busy computer may stop it again at once."""
    ready = page.locator("#status[data-phase=ready], #status[data-phase=moving]")
    for _ in range(10):
        # By force: the button says that it is disabled where the arm has been enabled in the meantime.
        page.locator("#enable").click(force=True)
        for _ in range(10):
            page.wait_for_timeout(100)
            if ready.count():
                return
    raise SystemExit("The arm is never enabled: " + page.locator("#status-text").inner_text())
