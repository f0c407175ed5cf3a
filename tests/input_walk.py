"""A random walk over everything that a person, a device and a browser can do to the page's inputs.

What the arm did comes from its process, by a connection that only watches; what was done to the page is known
here. As a command, in front of a server that drives a simulated arm:
``python tests/input_walk.py http://127.0.0.1:8000 --events 20000 --seed 1``.
"""

import argparse
import json
import math
import random
import sys
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Error, Page, sync_playwright
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from input_world import Push, Sample, World

SCRIPT = Path(__file__).with_name("input_walk_page.js").read_text()
DEFLECTED = 0.12
"""A gamepad is deflected from here on; the page's own limit is a little below."""

CHATTERS = ((25, 25, 20), (25, 25, 21), (75, 75, 7), (75, 75, 8), (100, 50, 9), (20, 130, 8), (45, 5, 30))
"""Down and up, ms, and how often."""

MOST_KEYS = 2

TICK_S = 0.01
LAG_WINDOW_S = 2.0

KEYS = ("ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight", "KeyW", "KeyD")


class Watcher:
    """The arm as its process says it."""

    def __init__(self) -> None:
        self.samples: list[Sample] = []
        self.reasons: Counter[str] = Counter()
        self.excused_until_s = -math.inf
        self._lags: deque[tuple[float, float]] = deque()
        self.state: dict[str, Any] = {}

    @property
    def enabled(self) -> bool:
        return self.state.get("phase") in ("ready", "moving")

    def listen(self, socket: Any) -> None:
        with suppress(ConnectionClosed):
            for frame in socket:
                message = json.loads(frame)
                if message["type"] == "state":
                    self._see(message, time.monotonic())

    def _see(self, state: dict[str, Any], now_s: float) -> None:
        was, self.state = self.enabled, state
        # A busy computer delivers states late: the least late of the last ones says when each was true.
        self._lags.append((now_s, now_s - TICK_S * state["tick"]))
        while self._lags[0][0] < now_s - LAG_WINDOW_S:
            self._lags.popleft()
        at_s = TICK_S * state["tick"] + min(lag for _, lag in self._lags)
        if was and not self.enabled and state["reason"] is not None:
            self.reasons[state["reason"]["code"]] += 1
        excused = state["returning"] or now_s < self.excused_until_s
        self.samples.append(Sample(at_s, now_s, self.enabled, excused, np.array(state["tool"])))


@contextmanager
def watching(address: str) -> Iterator[Watcher]:
    watcher = Watcher()
    with connect(f"{address.replace('http', 'ws', 1)}/drive", origin=address, compression=None) as socket:
        listener = threading.Thread(target=watcher.listen, args=[socket], daemon=True)
        listener.start()
        socket.send(json.dumps({"type": "hello", "version": 1, "name": "watcher"}))
        socket.send(json.dumps({"type": "release"}))
        while not watcher.state:
            time.sleep(0.01)
        yield watcher
    listener.join()


class Walk:
    """One page, what is done to it, and what that means for the arm."""

    def __init__(self, page: Page, watcher: Watcher, seed: int, log: Callable[[str], None]) -> None:
        self.page, self.watcher, self.log = page, watcher, log
        self.rng = random.Random(seed)  # noqa: S311
        self.world = World()
        self.events: Counter[str] = Counter()
        self.keys: set[str] = set()
        self.alive: set[int] = set()
        self.mouse: tuple[float, float] | None = None
        self.cdp = page.context.new_cdp_session(page)
        self.values = self._settings()

    # What people do.

    def key_down(self) -> None:
        if len(self.keys) == MOST_KEYS:
            return
        key = self.rng.choice([one for one in KEYS if one not in self.keys])
        self.keys.add(key)
        self._begin(f"key {key}")
        self._keys_change()
        self.page.keyboard.down(key)

    def key_up(self) -> None:
        if self.keys:
            key = self.rng.choice(sorted(self.keys))
            self.keys.discard(key)
            self.page.keyboard.up(key)
            self._end(f"key {key}")
            self._keys_change()

    def mouse_down(self) -> None:
        panel = self.values["panel"]
        target = {"stick": "#stick", "dpad": f"#dpad button:nth-child({self.rng.randint(1, 4)})"}.get(panel)
        if self.mouse is not None or target is None or not (box := self._box(target)):
            return
        x, y = (
            box[k] + self.rng.uniform(0.05, 0.95) * box[size] for k, size in (("x", "width"), ("y", "height"))
        )
        self.mouse = (x, y)
        self.page.mouse.move(x, y)
        if self.values["press"] == "latch":
            self.world.end_latched(time.monotonic())
            self._begin(f"latched-{panel} {time.monotonic()}", latched=True)
        elif panel == "dpad" and self.values["press"] == "step":
            self._begin("step")
        else:
            self._begin("mouse")
        self.page.mouse.down()
        if self.values["press"] == "step" and panel == "dpad":
            self.world.pushes[-1].ended_s = time.monotonic() + self.values["stepS"]

    def mouse_move(self) -> None:
        if self.mouse is not None:
            x, y = self.mouse
            self.mouse = (x + self.rng.uniform(-20, 20), y + self.rng.uniform(-20, 20))
            if self.world.now("mouse"):
                self._begin("mouse")
            self.page.mouse.move(*self.mouse)

    def mouse_up(self) -> None:
        if self.mouse is not None:
            self.mouse = None
            self.page.mouse.up()
            self._end("mouse")

    def release_missed(self) -> None:
        """The browser loses the release: the pointer moves with no button down."""
        if self.mouse is not None:
            x, y = self.mouse
            at = {"type": "mouseMoved", "x": x + 3, "y": y, "button": "none", "buttons": 0}
            self.cdp.send("Input.dispatchMouseEvent", at)
            self._end("mouse")
            if self.values["panel"] == "stick":
                self.world.end_latched(time.monotonic())
            self._pause(0.3)
            self.mouse_up()

    def press_switch(self) -> None:
        """As a person does: each press for 60 to 150 ms, and not two in a hurry."""
        if self.values["panel"] == "switch":
            self._press_switch(self.rng.randint(60, 150), 220, 1, counts=True)

    def chatter(self) -> None:
        if self.values["panel"] == "switch":
            self._press_switch(*self.rng.choice(CHATTERS), counts=False)

    # What gamepads do.

    def pad_plug(self) -> None:
        index = self.rng.randrange(3)
        axes = self.rng.choice([[0, 0], [0, 0], [0.7, 0], [0, -1], [-1, 0.2], [0.3, 0.3]])
        if not self.page.evaluate("(index) => pads[index]?.connected ?? false", index):
            self.alive.discard(index)
            self._pad(index, axes, f"alive.delete({index}); plug({index}, {axes})", counts=False)

    def pad_unplug(self) -> None:
        index = self.rng.randrange(3)
        if self.page.evaluate(
            "(index) => { const was = pads[index]; pads[index] = null; return was !== null; }", index
        ):
            self._end(f"pad {index}")

    def pad_push(self) -> None:
        index, turn = self.rng.randrange(3), self.rng.uniform(0, 2 * math.pi)
        size = self.rng.choice([0.3, 0.7, 1.0])
        axes = [size * math.cos(turn), size * math.sin(turn)]
        alive = self.rng.random() < 0.5
        self.alive = (self.alive - {index}) | ({index} if alive else set())
        script = (
            f"alive.{'add' if alive else 'delete'}({index}); if (pads[{index}]) pads[{index}].axes = {axes}"
        )
        self._pad(index, axes, script)

    def pad_rest(self) -> None:
        index = self.rng.randrange(3)
        axes = self.rng.choice([[0, 0], [0.04, -0.03]])
        self.alive.discard(index)
        self._pad(index, axes, f"alive.delete({index}); if (pads[{index}]) pads[{index}].axes = {axes}")

    def pad_freeze(self) -> None:
        """It goes on saying what it last said."""
        self.page.evaluate("alive.clear()")
        self.alive.clear()

    def pad_nonsense(self) -> None:
        index = self.rng.randrange(3)
        if self.page.evaluate(f"if (pads[{index}]) pads[{index}].axes = [NaN, 1]; pads[{index}] !== null"):
            self._pause(0.15)
            self._end(f"pad {index}")
            # What it says next may not be a new push.
            self._pad(index, [0.7, 0], f"pads[{index}].axes = [0.7, 0]", counts=False)

    def pad_button(self) -> None:
        index, button = self.rng.randrange(3), self.rng.randrange(1, 6)
        self._press_pad(index, button)

    # What stops and enables it.

    def enable(self) -> None:
        if self.watcher.enabled:
            return
        self.page.evaluate("document.getElementById('enable').click()")
        self._pause(0.15)

    def enable_by_pad(self) -> None:
        if not self.watcher.enabled and self.values["panel"] != "switch":
            self._press_pad(self.rng.randrange(3), 0)
            self._pause(0.3)

    def stop(self) -> None:
        self.page.keyboard.press(self.rng.choice(["Escape", "Space"]))

    def dialog(self) -> None:
        """Settings, with another way of pressing, and away again."""
        changes = [
            ("press", ["hold", "hold", "latch", "step"]),
            ("switches", ["1", "1", "2"]),
            ("tremor", ["off", "strong"]),
        ]
        name, values = self.rng.choice(changes)
        self._in_dialog(f"#settings [name={name}]", self.rng.choice(values))

    def panel(self) -> None:
        value = self.rng.choice(["stick", "stick", "dpad", "switch"])
        self.page.evaluate(
            "(value) => document.querySelector(`input[name=panel][value=${value}]`).click()", value
        )
        self.values = self._settings()

    def mode(self) -> None:
        self.page.keyboard.press("m")

    def blur(self) -> None:
        self.page.evaluate("window.dispatchEvent(new Event('blur'))")

    def reconnect(self) -> None:
        self.page.evaluate("sockets.at(-1).close()")
        self._pause(1.0)

    def hang(self) -> None:
        self.page.evaluate(
            "(() => { const end = performance.now() + 300; while (performance.now() < end); })()"
        )

    def alone(self) -> None:
        """One fault while everything else rests: nothing else explains what moves."""
        self.page.keyboard.press("Escape")
        self.mouse_up()
        while self.keys:
            self.key_up()
        self.pad_freeze()
        self.page.evaluate("pads.forEach((pad) => { if (pad) pad.axes = [0, 0]; }); pads[2] = null")
        for index in range(3):
            self._end(f"pad {index}")
        self.world.end_latched(time.monotonic())
        self._pause(0.5)
        self.enable()
        self._pause(1.2)
        fault = self.rng.choice(["appears", "misses", "chatters"])
        if fault == "appears":
            self._pad(2, [0.7, 0], "plug(2, [0.7, 0])", counts=False)
        elif fault == "misses":
            self.mouse_down()
            self._pause(0.3)
            self.release_missed()
        else:
            self.chatter()
        self._pause(1.5)

    def long_hold(self) -> None:
        """Nothing changes for longer than anything may last."""
        for _ in range(23):
            self._pause(0.5)
            self._note_alive()

    def start_again(self) -> None:
        """The arm jumps to its start, disengaged, so that it does not end in a corner."""
        self.page.keyboard.press("Escape")
        self._pause(0.5)
        self.watcher.excused_until_s = time.monotonic() + 1.5
        self.page.evaluate("sockets.at(-1).send(JSON.stringify({ type: 'reset' }))")
        self._pause(1.5)

    WEIGHTS: tuple[tuple[str, float], ...] = (
        *(("key_down", 12), ("key_up", 14), ("mouse_down", 12), ("mouse_move", 14), ("mouse_up", 10)),
        *(("release_missed", 3), ("press_switch", 8), ("chatter", 2), ("pad_plug", 4), ("pad_unplug", 1)),
        *(("pad_push", 14), ("pad_rest", 12), ("pad_freeze", 4), ("pad_nonsense", 1), ("pad_button", 1.5)),
        *(("enable_by_pad", 2), ("stop", 1), ("dialog", 1), ("panel", 2), ("mode", 1), ("blur", 0.5)),
        *(("reconnect", 0.3), ("hang", 0.3), ("long_hold", 0.25), ("start_again", 0.5), ("alone", 2)),
    )

    def go(self, events: int, longest_s: float = math.inf) -> None:
        """So many events, or as many as fit in the time."""
        end_s = time.monotonic() + longest_s
        names, weights = zip(*self.WEIGHTS, strict=True)
        for number in range(events):
            if time.monotonic() > end_s:
                break
            name = self.rng.choices(names, weights)[0]
            if not self.watcher.enabled and self.rng.random() < 0.4:
                name = "enable"
            self.events[name] += 1
            self.log(f"{time.monotonic():.3f} {number} {name} {self.values['panel']} {self.values['press']}")
            with suppress(Error):
                getattr(self, name)()
            self._note_alive()
            self._pause(self.rng.expovariate(1 / 0.02))
        # Whatever is held now must end too.
        self.mouse_up()
        while self.keys:
            self.key_up()
        self._pause(1.0)

    # How.

    def _begin(self, source: str, *, counts: bool = True, latched: bool = False) -> None:
        self.world.begin(source, time.monotonic(), counts, latched)

    def _end(self, source: str) -> None:
        self.world.end(source, time.monotonic())

    def _keys_change(self) -> None:
        """All of them together are one deflection."""
        for key in self.keys:
            self._begin(f"key {key}")

    def _note_alive(self) -> None:
        for index in self.alive:
            if self.world.now(f"pad {index}"):
                self._begin(f"pad {index}")

    def _pad(self, index: int, axes: list[float], script: str, *, counts: bool = True) -> None:
        source = f"pad {index}"
        pushed = math.hypot(*axes) > DEFLECTED
        there = self.page.evaluate("(index) => pads[index] !== null", index)
        if pushed and (there or not counts):
            self._begin(source, counts=counts)
        self.page.evaluate(script)
        if not pushed:
            self._end(source)

    def _press_pad(self, index: int, button: int) -> None:
        set_to = f"if (pads[{index}]) pads[{index}].buttons[{button}].pressed = "
        self.page.evaluate(set_to + "true")
        self._pause(0.13)
        self.page.evaluate(set_to + "false")

    def _press_switch(self, down_ms: int, up_ms: int, times: int, *, counts: bool) -> None:
        # A gamepad is read every 20 ms: contacts that open for 5 ms are held, to it.
        by = self.rng.choice(["key", "key", 0, 1]) if up_ms > 20 else "key"
        self.world.end_latched(time.monotonic())
        source = f"switch {time.monotonic()}"
        if counts:
            self._begin(source, latched=True)
        else:
            # The first press may begin something, and the next ends it.
            self.world.pushes.append(Push(source, time.monotonic(), ended_s=time.monotonic() + 0.15))
        self.page.evaluate("(given) => presses(...given)", [by, down_ms, up_ms, times])

    def _in_dialog(self, selector: str, value: str) -> None:
        script = """([selector, value]) => {
          document.getElementById("settings-open").click();
          const fields = [...document.querySelectorAll(selector)];
          const one = fields.find((field) => field.type !== "radio" || field.value === value);
          if (one.type === "radio") one.checked = true;
          else one.value = value;
          one.dispatchEvent(new Event("input", { bubbles: true }));
          one.dispatchEvent(new Event("change", { bubbles: true }));
        }"""
        self.page.evaluate(script, [selector, value])
        self._pause(0.1)
        self.page.evaluate("document.getElementById('settings-close').click()")
        self.values = self._settings()

    def _settings(self) -> dict[str, Any]:
        stored = self.page.evaluate("JSON.parse(localStorage['latentarm.settings.'])")
        return {"panel": "stick", "press": "hold", "stepS": 0.5, **stored}

    def _box(self, selector: str) -> dict[str, float] | None:
        script = """(selector) => {
          const one = document.querySelector(selector);
          one.scrollIntoView({ block: "nearest" });
          const { x, y, width, height } = one.getBoundingClientRect();
          return width ? { x, y, width, height } : null;
        }"""
        return self.page.evaluate(script, selector)

    def _pause(self, for_s: float) -> None:
        self.page.wait_for_timeout(1000 * for_s)


@contextmanager
def walking(page: Page, address: str, seed: int, log: Callable[[str], None]) -> Iterator[Walk]:
    """A page that drives, and a watcher of its arm."""
    page.add_init_script(SCRIPT)
    with watching(address) as watcher:
        page.goto(address)
        page.locator("#status:not([data-phase=connecting], [data-phase=lost])").wait_for()
        yield Walk(page, watcher, seed, log)


def report(walk: Walk) -> tuple[str, int]:
    """What came of it, in words, and how many motions nobody asked for."""
    samples = walk.watcher.samples
    steps = [float(np.linalg.norm(b.tool - a.tool)) for a, b in pairwise(samples) if not b.excused]
    found = walk.world.unexplained(samples)
    lines = [
        f"{walk.events.total()} events in {samples[-1].at_s - samples[0].at_s:.0f} s: {dict(walk.events)}",
        f"{len(samples)} states, {sum(step > 1e-4 for step in steps)} in motion, {sum(steps):.2f} m",
        f"deflected in motion: {dict(walk.world.kinds(samples))}",
        f"stopped by: {dict(walk.watcher.reasons)}",
        f"not explained: {len(found)} states, {sum(moved for _, moved in found):.4f} m",
        *(f"  {at_s:.3f} {1000 * moved:.2f} mm" for at_s, moved in found[:20]),
    ]
    return "\n".join(lines), len(found)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("address")
    parser.add_argument("--events", type=int, default=20_000)
    parser.add_argument("--minutes", type=float, default=math.inf)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--chromium", default="/usr/bin/chromium")
    parser.add_argument("--log", type=Path, default=Path("input_walk.log"))
    given = parser.parse_args()
    # What is drawn is of no interest here, and without a graphics processor it keeps inputs waiting.
    without = ["--disable-3d-apis", "--no-sandbox"]
    with sync_playwright() as playwright, given.log.open("w") as log:
        browser = playwright.chromium.launch(executable_path=given.chromium, args=without)
        page = browser.new_page(viewport={"width": 1100, "height": 720})
        with walking(page, given.address, given.seed, lambda line: print(line, file=log, flush=True)) as walk:
            walk.go(given.events, 60.0 * given.minutes)
            words, faults = report(walk)
        browser.close()
    sys.stdout.write(f"{words}\n")
    return min(faults, 1)


if __name__ == "__main__":
    sys.exit(main())
