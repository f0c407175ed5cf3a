"""A real server, started by the command line, and a real Chromium in front of it."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, Page, sync_playwright
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SOFTWARE_GL = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
HERE = Path(__file__).parent

STICKS_OUT = """() => [...document.querySelectorAll("body *")]
  .filter((one) => one.checkVisibility({ visibilityProperty: true }) && !one.closest(".skip, .labels, svg"))
  .filter((one) => {  // what is clipped away is for screen readers
    let at = one;
    while (at && getComputedStyle(at).clipPath !== "inset(50%)") at = at.parentElement;
    return !at;
  })
  .map((one) => [one.getBoundingClientRect(), one])
  .filter(([box]) => box.width > 0 && (box.left < -1 || box.right > innerWidth + 1))
  .map(([, one]) => one.outerHTML.slice(0, 120))"""
"""What is wider than the screen, or reaches beyond it on either side."""

SETTLING_S = 0.2
"""The simulated arm follows its last command, zero, within this."""

TRIES = 8
"""A busy computer keeps inputs waiting, and the arm stops then, as it must: a person enables it again."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if HERE in item.path.parents:
            item.add_marker(pytest.mark.browser)
            # Minutes, and a machine that draws without a graphics processor: `make test-all`.
            item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """One browser for all tests; each opens pages of its own in it."""
    found = find_chromium()
    # Chromium does not run sandboxed as root, which is what containers run as.
    sandbox = ("--no-sandbox",) if os.getuid() == 0 else ()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=[*SOFTWARE_GL, *sandbox])
        yield browser
        browser.close()


def find_chromium() -> str:
    """The Chromium of this machine; whoever asks is skipped where there is none."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip(f"No Chromium is installed: looked for {', '.join(NAMES)}.")
    return found


@contextmanager
def started(folder: Path, *arguments: str) -> Iterator[str]:
    """Where `latentarm teleop` serves its page; recordings go to ``folder``."""
    command = [sys.executable, "-m", "latentarm", "teleop", *arguments, "--port", "0", "--out", str(folder)]
    with (folder / "said").open("w") as said:
        server = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT)
    try:
        yield _printed_address(server, folder / "said")
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(20)


@pytest.fixture(scope="session")
def address(trained: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Where `latentarm teleop RUN` serves its page."""
    with started(tmp_path_factory.mktemp("teleop"), str(trained)) as address:
        yield address


@pytest.fixture(scope="session")
def start_server() -> Callable[..., AbstractContextManager[str]]:
    """A server of its own for a test that changes what is driven."""
    return started


@pytest.fixture(scope="session")
def serve_task(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., AbstractContextManager[str]]:
    """A server with a task of this folder that another distribution registers."""

    @contextmanager
    def serve_task(name: str, place: str, *arguments: str) -> Iterator[str]:
        folder = tmp_path_factory.mktemp(name)
        (info := folder / f"{name}-1.0.dist-info").mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_text(f"[latentarm.scene_tasks]\n{name} = {place}\n")
        path = [str(folder), str(HERE), os.environ.get("PYTHONPATH", "")]
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("PYTHONPATH", os.pathsep.join(path))
            with started(folder, "--task", name, *arguments) as address:
                yield address

    return serve_task


@pytest.fixture(scope="session")
def watch() -> Callable[[str], AbstractContextManager[Any]]:
    """Watches the arm of such a server."""
    return _watching


def _printed_address(server: subprocess.Popen[bytes], said: Path) -> str:
    end_s = time.monotonic() + 60
    while time.monotonic() < end_s and server.poll() is None:
        found = re.search(r"https?://[\d.]+:\d+", said.read_text())
        if found and not _refuses(found.group()):
            return found.group()
        time.sleep(0.1)
    raise AssertionError(f"the server did not start: {said.read_text()}")


def _refuses(address: str) -> bool:
    try:
        with connect(f"{address.replace('http', 'ws', 1)}/drive", origin=address):
            return False
    except OSError:
        return True


class Arm:
    """The arm as the server has it: a connection of its own that only watches."""

    def __init__(self) -> None:
        self.state: dict[str, Any] = {}
        self.welcome: dict[str, Any] = {}
        self.learning: dict[str, Any] = {}
        self.ghosts: dict[str, list[list[float]]] = {}
        self.things: dict[str, list[list[float]]] = {}
        self.states: list[dict[str, Any]] = []
        self.tell: Callable[[str], None] = lambda message: None

    @property
    def tool(self) -> np.ndarray:
        return np.array(self.state["tool"])

    @property
    def goals(self) -> dict[str, np.ndarray]:
        return {goal["name"]: np.array(goal["position"]) for goal in self.welcome["goals"]}

    @property
    def enabled(self) -> bool:
        return self.state["phase"] in ("ready", "moving")

    def comes_to(self, until: Callable[[], Any], within_s: float) -> bool:
        end_s = time.monotonic() + within_s
        while time.monotonic() < end_s:
            if self.state and until():
                return True
            time.sleep(0.01)
        return False

    def wait(self, until: Callable[[], Any], within_s: float = 8.0) -> None:
        if self.comes_to(until, within_s):
            return
        shown = {
            key: self.state.get(key) for key in ("phase", "note", "reason", "mode", "axes", "driver", "tool")
        }
        raise AssertionError(f"it never came to that: {shown}")

    def comes_to_rest(self) -> None:
        """Disengaged within a second, and not moving any more."""
        self.wait(lambda: self.state["phase"] in ("disengaged", "neutral_needed"), 1.0)
        time.sleep(SETTLING_S)
        self.stays()

    def is_let_go(self) -> None:
        """At rest within a second, enabled or not."""
        self.wait(lambda: self.state["phase"] not in ("moving", "stopping"), 1.0)
        time.sleep(SETTLING_S)
        self.stays()

    def stays(self, for_s: float = 0.5) -> None:
        """It does not move."""
        before, tick = self.tool, self.state["tick"]
        time.sleep(for_s)
        assert self.state["tick"] > tick, "the server says nothing new"
        assert np.array_equal(before, self.tool)

    def start_again(self) -> None:
        """Put the arm and what is about it back by a jump; nobody drives, before and after."""
        self.wait(lambda: self.state["driver"] is None)
        for message, done in (
            ("ask_to_drive", lambda: self.state["you"]),
            ("reset", lambda: self.state["at_start"] and self.state["phase"] == "disengaged"),
            ("release", lambda: self.state["driver"] is None),
        ):
            before = self.state["tick"]
            self.tell(json.dumps({"type": message}))
            self.wait(lambda done=done, before=before: self.state["tick"] > before + 20 and done())

    def listen(self, socket: Any) -> None:
        with suppress(ConnectionClosed):
            for frame in socket:
                message = json.loads(frame)
                if message["type"] == "welcome":
                    self.welcome = message
                elif message["type"] == "learning":
                    self.learning = message
                elif message["type"] == "state":
                    if message["ghosts"] and message["ghosts"].pop("ring"):
                        self.ghosts = message["ghosts"]
                    self.things = message["things"] or self.things
                    self.state = message


@contextmanager
def _watching(address: str) -> Iterator[Arm]:
    arm = Arm()
    with connect(f"{address.replace('http', 'ws', 1)}/drive", origin=address, compression=None) as socket:
        listener = threading.Thread(target=arm.listen, args=[socket], daemon=True)
        listener.start()
        arm.tell = socket.send
        socket.send(json.dumps({"type": "hello", "version": 1, "name": "test"}))
        arm.wait(lambda: arm.welcome and arm.ghosts, 60.0)
        # The first to come drives: not this one.
        socket.send(json.dumps({"type": "release"}))
        yield arm
    listener.join()


@pytest.fixture(scope="session")
def arm(address: str) -> Iterator[Arm]:
    with _watching(address) as arm:
        yield arm


@pytest.fixture
def open_page(chromium: Browser, address: str, arm: Arm) -> Iterator[Callable[..., Page]]:
    """Opens a page in a browser profile of its own; an error on any of them fails the test."""
    errors: list[str] = []
    contexts = []

    def open_page(script: str = "", **options: Any) -> Page:
        context = chromium.new_context(**{"viewport": {"width": 1100, "height": 720}, **options})
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(10_000)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
        if script:
            page.add_init_script(script)
        page.goto(address)
        page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
        # The drawing is loaded last.
        page.locator(".label").first.wait_for(state="attached")
        return page

    yield open_page
    for context in contexts:
        context.close()
    arm.wait(lambda: arm.state["driver"] is None)
    assert errors == []


@pytest.fixture
def page(open_page: Callable[..., Page], arm: Arm) -> Page:
    """A page who drives, the arm at its start in latent actions with help, not enabled."""
    return seated(open_page(), arm)


def seated(page: Page, arm: Arm) -> Page:
    """The page drives, and the arm is at its start."""
    arm.start_again()
    ask_to_drive(page)
    page.get_by_role("radio", name="Learned motions").check()
    page.get_by_role("radio", name="Fast").check()
    with set_up(page) as dialog:
        dialog.get_by_role("group", name="Help from the robot").get_by_role("radio", name="Medium").check()
    arm.wait(lambda: arm.state["mode"] == "assisted")
    return page


@contextmanager
def set_up(page: Page) -> Iterator[Locator]:
    """Everything but driving, as long as the block lasts; the arm is stopped for it."""
    page.locator("#settings-open").click()
    yield page.get_by_role("dialog")
    page.locator("#settings-close").click()


def control_with(page: Page, name: str) -> None:
    """Press the stick, buttons or a switch from now on."""
    with set_up(page) as dialog:
        dialog.get_by_role("radio", name=name, exact=True).check()


def ask_to_drive(page: Page) -> None:
    """Drive, where nobody else does."""
    with set_up(page) as dialog:
        dialog.get_by_role("button", name="Ask to drive").click()
        dialog.get_by_role("button", name="Let others drive").wait_for()


def driven_back(page: Page, arm: Arm) -> None:
    """A page that drives has the arm driven back to its start, and stops it there."""
    for _ in range(TRIES):
        if arm.state["at_start"]:
            break
        enable(page, arm)
        # At once: who waits for a moving arm to rest may find it stopped.
        page.locator("#way-back").dispatch_event("click")
        arm.comes_to(lambda: arm.state["returning"], 1.0)
        arm.comes_to(lambda: not arm.state["returning"], 20.0)
    assert arm.state["at_start"], arm.state["reason"]
    page.keyboard.press("Escape")
    arm.comes_to_rest()


def press_switch(page: Page, key: str) -> None:
    """Press a switch's key as long as the page asks, and not sooner than a person sees what is lit."""
    page.wait_for_timeout(220)
    page.keyboard.press(key, delay=80)


def enable(page: Page, arm: Arm) -> None:
    """Enable the arm, unless it is enabled."""
    for _ in range(TRIES):
        if arm.enabled:
            return
        page.get_by_role("button", name="Enable", exact=True).click()
        if arm.comes_to(lambda: arm.enabled, 1.5):
            return
    raise AssertionError(f"the arm is never enabled: {arm.state['reason']}")


def move(page: Page, arm: Arm, press: Callable[[], Any], let_go: Callable[[], Any]) -> None:
    """Press until the arm moves, and keep on pressing."""
    for _ in range(TRIES):
        press()
        if arm.comes_to(lambda: arm.state["phase"] == "moving", 1.5):
            return
        let_go()
        enable(page, arm)
    raise AssertionError(f"the arm never moves: {arm.state['reason']}")


@pytest.fixture
def seat() -> Callable[[Page, Arm], Page]:
    return seated


@pytest.fixture
def drive_back() -> Callable[[Page, Arm], None]:
    return driven_back


@pytest.fixture
def enabled(page: Page, arm: Arm) -> Page:
    """A page who drives of an enabled arm."""
    enable(page, arm)
    return page


def drag(page: Page, right: float, up: float) -> None:
    """Take the stick in its middle and push it, in shares of its whole drawing."""
    stick = page.locator("#stick")
    stick.scroll_into_view_if_needed()
    box = stick.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + right * box["width"], y - up * box["height"], steps=3)


def comes_true(page: Page, expression: str, argument: Any = None, within_s: float = 10.0) -> None:
    """Wait until something holds in the page. Playwright's own way needs `eval`, which the page forbids."""
    end_s = time.monotonic() + within_s
    while not page.evaluate(expression, argument):
        assert time.monotonic() < end_s, f"it never came to that: {expression}"
        page.wait_for_timeout(30)


@pytest.fixture
def wait_in_page() -> Callable[..., None]:
    return comes_true


@pytest.fixture
def drag_stick() -> Callable[[Page, float, float], None]:
    return drag


@pytest.fixture
def press_until_moving() -> Callable[[Page, Arm, Callable[[], Any], Callable[[], Any]], None]:
    return move


@pytest.fixture
def hold_key(arm: Arm) -> Callable[[Page], None]:
    """Hold an arrow key until the arm moves."""

    def press(page: Page) -> None:
        page.locator("#stick").focus()
        page.keyboard.down("ArrowLeft")

    return lambda page: move(page, arm, partial(press, page), partial(page.keyboard.up, "ArrowLeft"))


@pytest.fixture(scope="session")
def add_person() -> Callable[[Page, str, str], None]:
    return add


def add(page: Page, address: str, name: str) -> None:
    """Add a person on their page, and go to the one with the arm as that person."""
    page.goto(f"{address}/people")
    page.locator("#add input").fill(name)
    page.get_by_role("button", name="Add a person").click()
    page.get_by_role("button", name=f"Choose {name}").wait_for()
    page.goto(address)
    page.locator(".label").first.wait_for(state="attached")


@pytest.fixture(scope="session")
def press_enable() -> Callable[[Page, Arm], None]:
    return enable
