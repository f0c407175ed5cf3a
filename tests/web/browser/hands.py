"""The inputs of the page as people use them, one class for each."""

import json
from contextlib import suppress
from typing import Any, ClassVar

from playwright.sync_api import Error, Page

from .conftest import press_switch

PUSH = {"up": (0, 1), "down": (0, -1), "left": (-1, 0), "right": (1, 0)}
FULL = 0.4
"""A full push of the stick, in shares of its drawing."""
TAP_S = 0.08
PATIENCE_MS = 10_000.0
"""A busy computer takes this long to show what is pressed."""
ENDS_MS = 1500.0
"""A person with a switch waits for so long, after the time that a push should take, until it ends."""
SCANNED_MS = 12_000.0
"""All choices have been lit within this."""

PAD = """
window.pad = { index: 0, id: "pad", mapping: "standard", connected: true, axes: [0, 0],
  buttons: Array.from({ length: 6 }, () => ({ pressed: false })) };
navigator.getGamepads = () => (window.pad ? [window.pad] : [null]);
"""


class Hand:
    """An input; ``presses`` counts what the person did with it."""

    settings: ClassVar[dict[str, Any]] = {}
    """Of the page, for this input."""
    own_script: ClassVar[str] = ""
    speed: ClassVar[float] = 1.0
    """Chosen on the page, as a share of the full one."""
    touch: ClassVar[bool] = False
    gives_up_s: ClassVar[float] = 300.0
    """Nobody drives one task for longer."""

    def __init__(self, page: Page) -> None:
        self.page, self.presses = page, 0

    @classmethod
    def script(cls) -> str:
        """To run before the scripts of the page."""
        values = json.dumps({"practised": True, "sensitivity": cls.speed, **cls.settings})
        return f"{cls.own_script}localStorage['latentarm.settings.'] ??= {json.dumps(values)};"

    def push(self, direction: str) -> None:
        """Begin to push in a direction of `PUSH`."""
        raise NotImplementedError

    def await_end(self) -> None:
        """Wait a little for a push that ends by itself where its way ends, as those of a switch do."""

    def let_go(self) -> None:
        """Push no more."""
        raise NotImplementedError

    def enable(self) -> None:
        """Enable the arm."""
        raise NotImplementedError

    def pair(self, number: int) -> None:
        """Choose this pair of directions, or come nearer to it."""
        raise NotImplementedError

    def gripper(self, what: str) -> None:
        """Have the gripper ``open`` or ``close``."""
        raise NotImplementedError


class Keyboard(Hand):
    """Clicks on nothing: arrow keys, Enter, digits and G."""

    def __init__(self, page: Page) -> None:
        super().__init__(page)
        self._down: str | None = None
        page.locator("#stick").focus()

    def push(self, direction: str) -> None:
        self.presses += 1
        self._down = f"Arrow{direction.capitalize()}"
        self.page.keyboard.down(self._down)

    def let_go(self) -> None:
        if self._down:
            self.page.keyboard.up(self._down)
        self._down = None

    def enable(self) -> None:
        self._press("Enter")

    def pair(self, number: int) -> None:
        self._press(f"Digit{number + 1}")

    def gripper(self, what: str) -> None:
        self._press("KeyG")

    def _press(self, key: str) -> None:
        self.presses += 1
        self.page.keyboard.press(key, delay=1000 * TAP_S)


class Pointer(Hand):
    """Drags the stick with a mouse, and clicks."""

    def push(self, direction: str) -> None:
        self.presses += 1
        middle, end = _way(self.page, direction)
        self.page.mouse.move(*middle)
        self.page.mouse.down()
        self.page.mouse.move(*end, steps=3)

    def let_go(self) -> None:
        self.page.mouse.up()

    def enable(self) -> None:
        self._click("#enable")

    def pair(self, number: int) -> None:
        self._click(f"#axes label >> nth={number}")

    def gripper(self, what: str) -> None:
        self._click(f"#gripper-{what}")

    def _click(self, where: str) -> None:
        self.presses += 1
        # A person presses what they see, whether or not it is ready.
        self.page.locator(where).click(timeout=PATIENCE_MS, force=True)


class Finger(Pointer):
    """The same with a finger."""

    touch = True

    def __init__(self, page: Page) -> None:
        super().__init__(page)
        # A touch ends with the session in which it began.
        self._screen = page.context.new_cdp_session(page)

    def push(self, direction: str) -> None:
        self.presses += 1
        middle, end = _way(self.page, direction)
        self._touch("touchStart", middle)
        self._touch("touchMove", end)

    def let_go(self) -> None:
        self._touch("touchEnd")

    def _touch(self, kind: str, *points: tuple[float, float]) -> None:
        places = [{"x": x, "y": y} for x, y in points]
        self._screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    def _click(self, where: str) -> None:
        self.presses += 1
        self.page.locator(where).tap(timeout=PATIENCE_MS, force=True)


class Buttons(Pointer):
    """Holds the direction buttons with a mouse."""

    settings: ClassVar = {"panel": "dpad"}

    def push(self, direction: str) -> None:
        self.presses += 1
        self.page.locator(f"#dpad [data-direction={direction}]").hover(timeout=PATIENCE_MS)
        self.page.mouse.down()


class Gamepad(Hand):
    """Tilts the first stick of a gamepad, and has a button for all else."""

    own_script = PAD

    def push(self, direction: str) -> None:
        right, up = PUSH[direction]
        self.presses += 1
        self.page.evaluate("axes => { pad.axes = axes; }", [right, -up])

    def let_go(self) -> None:
        self.page.evaluate("pad.axes = [0.02, -0.01]")

    def enable(self) -> None:
        self._press(0)

    def gripper(self, what: str) -> None:
        self._press(2)

    def pair(self, number: int) -> None:
        self._press(4)

    def _press(self, number: int) -> None:
        self.presses += 1
        for pressed in (True, False):
            self.page.evaluate("([at, is]) => { pad.buttons[at].pressed = is; }", [number, pressed])
            self.page.wait_for_timeout(250)


class OneSwitch(Hand):
    """Has one key, and waits for the light; a second press ends a motion."""

    settings: ClassVar = {"panel": "switch", "dwellS": 0.6}
    speed = 0.5
    gives_up_s = 900.0

    def push(self, direction: str) -> None:
        self._choose(direction)

    def await_end(self) -> None:
        with suppress(Error):
            self.page.locator("#scan li[data-moving=true]").wait_for(state="detached", timeout=ENDS_MS)

    def let_go(self) -> None:
        if self.page.locator("#scan li[data-moving=true]").count():
            self._press("Enter")

    def enable(self) -> None:
        self._choose("enable")

    def gripper(self, what: str) -> None:
        self._choose("gripper")

    def pair(self, number: int) -> None:
        self._choose("mode")

    def _choose(self, choice: str) -> None:
        wanted = f"#scan li[data-choice={choice}]"
        # A press that came late may have opened another list. The arm's way back is something else.
        back = "#scan li[data-choice$=-back]:not([data-choice=way-back])"
        if not self.page.locator(wanted).count() and self.page.locator(back).count():
            wanted = back
        # The choices change when the arm stops by itself: then there is nothing to wait for.
        with suppress(Error):
            self._light(f"{wanted}[aria-current=true]")
            self._press("Enter")

    def _light(self, lit: str) -> None:
        self.page.locator(lit).wait_for(timeout=SCANNED_MS)

    def _press(self, key: str) -> None:
        self.presses += 1
        press_switch(self.page, key)


class TwoSwitches(OneSwitch):
    """Goes on to the choice with one key, and takes it with the other."""

    settings: ClassVar = {"panel": "switch", "switches": "2"}

    def _light(self, lit: str) -> None:
        for _ in range(30):
            if self.page.locator(lit).count():
                return
            self._press("Backspace")


HANDS = {
    "keyboard": Keyboard,
    "stick": Pointer,
    "finger": Finger,
    "buttons": Buttons,
    "gamepad": Gamepad,
    "one switch": OneSwitch,
    "two switches": TwoSwitches,
}


def _way(page: Page, direction: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """The middle of the stick and where it is pushed to, px."""
    box = page.locator("#stick").bounding_box()
    assert box is not None
    right, up = PUSH[direction]
    x, y, far = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, FULL * box["width"]
    return (x, y), (x + right * far, y - up * far)
