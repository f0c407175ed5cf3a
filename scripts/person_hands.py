"""Seven ways of pressing, as a person has them at the page; each counts its presses."""

import time
from abc import ABC, abstractmethod
from typing import Final

from playwright.sync_api import Locator, Page

from person_page import Direction, choices, look, moving

KEYS: Final = {"Up": "ArrowUp", "Down": "ArrowDown", "Left": "ArrowLeft", "Right": "ArrowRight"}
WAYS: Final = {"Up": (0, 1), "Down": (0, -1), "Left": (-1, 0), "Right": (1, 0)}
PAIRS: Final = ("Across", "Height, turn", "Tilt")
TAP_S: Final = 0.08
"""How long a key or a button is down where it need not be held, s."""

LOOKS_S: Final = 0.03
"""From one look at the light to the next, s."""

GONE_S: Final = 0.5
"""A choice that is not offered for so long is not waited for, s."""

BACK: Final = "Back"
"""The choice that leads out of what another one has opened."""

GAMEPAD: Final = """
const buttons = Array.from({ length: 8 }, () => ({ pressed: false, touched: false, value: 0 }));
window.pad = { index: 0, id: "scripted", connected: true, mapping: "standard", axes: [0, 0, 0, 0], buttons };
navigator.getGamepads = () => [window.pad];
"""
STICK_REACH: Final = 96 / 264
"""From the middle of the stick's drawing to where it is pushed all the way, as a share of its width."""


class Hand(ABC):
    """A person's way of pressing.

    Args:
        page: that they press on, open and in English.

    Attributes:
        presses: how often they have pressed.
    """

    script = ""
    """What the page is given before it loads; "" for nothing."""

    at = "#stick"
    """What has the focus while they drive."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.presses = 0

    @abstractmethod
    def sit_down(self) -> None:
        """Choose what is needed on the page, once; not counted."""

    @abstractmethod
    def push(self, direction: Direction, hold_s: float) -> None:
        """Push and let go after so long."""

    @abstractmethod
    def enable(self) -> None:
        """Press Enable."""

    @abstractmethod
    def choose(self, pair: int, now: int) -> None:
        """Choose a pair of directions; another one is chosen now."""

    @abstractmethod
    def grip(self, close: bool) -> None:
        """Close or open the gripper."""

    def click(self, selector: str) -> None:
        """Click on something with the mouse."""
        self.presses += 1
        bring(self.page, selector)
        self.page.locator(selector).click(force=True)


class ScreenHand(Hand):
    """On the stick and the buttons that the page shows."""

    def sit_down(self) -> None:
        """See the base class. The page begins with the stick."""

    def push(self, direction: Direction, hold_s: float) -> None:
        """See the base class."""
        self.presses += 1
        bring(self.page, "#stick")
        x, y, reach = middle_of(self.page, "#stick")
        across, along = WAYS[direction]
        self._put_down(x, y)
        self._drag(x + across * reach, y - along * reach)
        time.sleep(hold_s)
        self._lift()

    def enable(self) -> None:
        """See the base class."""
        self._press("#enable")

    def choose(self, pair: int, now: int) -> None:
        """See the base class."""
        self._press(f"#axes label:nth-child({pair + 1})")

    def grip(self, close: bool) -> None:
        """See the base class."""
        self._press("#gripper-close" if close else "#gripper-open")

    @abstractmethod
    def _press(self, selector: str) -> None: ...

    @abstractmethod
    def _put_down(self, x: float, y: float) -> None: ...

    @abstractmethod
    def _drag(self, x: float, y: float) -> None: ...

    @abstractmethod
    def _lift(self) -> None: ...


class PointerHand(ScreenHand):
    """The mouse."""

    def _press(self, selector: str) -> None:
        self.click(selector)

    def _put_down(self, x: float, y: float) -> None:
        self.page.mouse.move(x, y)
        self.page.mouse.down()

    def _drag(self, x: float, y: float) -> None:
        self.page.mouse.move(x, y)

    def _lift(self) -> None:
        self.page.mouse.up()


class DpadHand(PointerHand):
    """The mouse, on the large buttons."""

    def sit_down(self) -> None:
        """See the base class."""
        self.page.get_by_role("radio", name="Buttons").check()

    def push(self, direction: Direction, hold_s: float) -> None:
        """See the base class."""
        self.presses += 1
        bring(self.page, "#dpad")
        x, y, _ = middle_of(self.page, f"#dpad [data-direction={direction.lower()}]")
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        time.sleep(hold_s)
        self.page.mouse.up()


class KeyboardHand(Hand):
    """Arrow keys; Enter, digits and G."""

    def sit_down(self) -> None:
        """See the base class. The page begins with the stick."""

    def push(self, direction: Direction, hold_s: float) -> None:
        """See the base class."""
        self._press(KEYS[direction], hold_s)

    def enable(self) -> None:
        """See the base class."""
        self._press("Enter")

    def choose(self, pair: int, now: int) -> None:
        """See the base class."""
        self._press(f"Digit{pair + 1}")

    def grip(self, close: bool) -> None:
        """See the base class."""
        self._press("KeyG")

    def _press(self, key: str, hold_s: float = TAP_S) -> None:
        self.presses += 1
        self.page.keyboard.down(key)
        time.sleep(hold_s)
        self.page.keyboard.up(key)


class GamepadHand(Hand):
    """The first stick of a gamepad and its buttons; the browser's own list of gamepads is stood in for."""

    script = GAMEPAD

    def sit_down(self) -> None:
        """See the base class. The page begins with the stick."""

    def push(self, direction: Direction, hold_s: float) -> None:
        """See the base class."""
        self.presses += 1
        across, along = WAYS[direction]
        self.page.evaluate("([x, y]) => { window.pad.axes = [x, y, 0, 0]; }", [across, -along])
        time.sleep(hold_s)
        self.page.evaluate("() => { window.pad.axes = [0, 0, 0, 0]; }")

    def enable(self) -> None:
        """See the base class."""
        self._press(0)

    def choose(self, pair: int, now: int) -> None:
        """See the base class. A shoulder button goes on to the next pair."""
        for _ in range((pair - now) % len(PAIRS)):
            self._press(4)
            time.sleep(0.15)

    def grip(self, close: bool) -> None:
        """See the base class."""
        self._press(2)

    def _press(self, button: int) -> None:
        self.presses += 1
        self.page.evaluate("(number) => { window.pad.buttons[number].pressed = true; }", button)
        # It is read ten times a second while the arm is not enabled.
        time.sleep(0.15)
        self.page.evaluate("(number) => { window.pad.buttons[number].pressed = false; }", button)


class TouchHand(ScreenHand):
    """A finger on a phone."""

    def __init__(self, page: Page) -> None:
        """See the base class."""
        super().__init__(page)
        self._session = page.context.new_cdp_session(page)

    def _press(self, selector: str) -> None:
        self.presses += 1
        bring(self.page, selector)
        self.page.locator(selector).tap(force=True)

    def _put_down(self, x: float, y: float) -> None:
        self._touch("touchStart", x, y)

    def _drag(self, x: float, y: float) -> None:
        self._touch("touchMove", x, y)

    def _lift(self) -> None:
        self._session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    def _touch(self, kind: str, x: float, y: float) -> None:
        self._session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y}]})


class SwitchHand(Hand):
    """One switch: the light moves by itself, a press takes what is lit, and the next one ends a motion."""

    at = "#switch"
    dwell_s = 0.6
    """How long each choice stays lit: a practised user's; the page begins with 1.2 s."""

    def sit_down(self) -> None:
        """See the base class."""
        self.page.get_by_role("button", name="Settings").click()
        dialog = self.page.get_by_role("dialog")
        self.set_up(dialog)
        dialog.get_by_role("button", name="Done").click()
        self.page.get_by_role("radio", name="Switch").check()

    def set_up(self, dialog: Locator) -> None:
        """Choose what is needed in the settings."""
        dialog.get_by_label("Time on each choice").fill(str(self.dwell_s))

    def push(self, direction: Direction, hold_s: float) -> None:
        """See the base class."""
        if not self.take(direction):
            return
        end_s = time.monotonic() + hold_s - TAP_S
        while time.monotonic() < end_s:
            time.sleep(LOOKS_S)
            if not moving(self.page):
                # The arm has stopped by itself: a press would now take a choice.
                return
        self.press("Enter")

    def enable(self) -> None:
        """See the base class."""
        self.take("Enable")

    def choose(self, pair: int, now: int) -> None:
        """See the base class."""
        for _ in range((pair - now) % len(PAIRS)):
            self.take("Other mode")
            time.sleep(0.15)

    def grip(self, close: bool) -> None:
        """See the base class."""
        self.take("Close gripper" if close else "Open gripper")

    def take(self, name: str) -> bool:
        """Wait until a choice is lit, and press.

        Returns:
            Whether it was lit: it may have gone, as directions do when the arm has stopped.
        """
        gone_at_s = None
        while True:
            names, lit = choices(self.page)
            if lit == name:
                self.press("Enter")
                return True
            if name in names:
                gone_at_s = None
                self.go_on()
                continue
            gone_at_s = gone_at_s or time.monotonic()
            if time.monotonic() - gone_at_s > GONE_S:
                if BACK in names:
                    # A press that came late has opened something.
                    self.take(BACK)
                    gone_at_s = None
                    continue
                return False
            time.sleep(LOOKS_S)

    def go_on(self) -> None:
        """Wait for the light."""
        time.sleep(LOOKS_S)

    def press(self, key: str) -> None:
        """Press a switch, which types a key."""
        self.presses += 1
        self.page.keyboard.down(key)
        time.sleep(TAP_S)
        self.page.keyboard.up(key)


class TwoSwitchesHand(SwitchHand):
    """Two switches: one moves the light, the other takes what is lit."""

    def set_up(self, dialog: Locator) -> None:
        """See the base class."""
        dialog.get_by_label("Two switches").check()

    def go_on(self) -> None:
        """See the base class."""
        self.press("Backspace")
        time.sleep(3 * TAP_S)  # The page counts no press sooner.


HANDS: Final[dict[str, type[Hand]]] = {
    "pointer": PointerHand,
    "keyboard": KeyboardHand,
    "dpad": DpadHand,
    "gamepad": GamepadHand,
    "one switch": SwitchHand,
    "two switches": TwoSwitchesHand,
    "touch": TouchHand,
}


BRING: Final = """(selector) => {
  const element = document.querySelector(selector);
  const bar = document.querySelector(".action-bar");
  const [box, under] = [element, bar].map((one) => one.getBoundingClientRect());
  const hidden = box.top < 0 || box.bottom > under.top;
  if (hidden && !bar.contains(element)) element.scrollIntoView({ block: "center" });
}"""


def bring(page: Page, selector: str) -> None:
    """Scroll as a person does to what is not to be seen, or is under the bar with Stop."""
    page.evaluate(BRING, selector)


def middle_of(page: Page, selector: str) -> tuple[float, float, float]:
    """The middle of something on the screen, and how far a stick of its width is pushed from there, px.

    Raises:
        RuntimeError: it is not to be seen.
    """
    box = page.locator(selector).bounding_box()
    if box is None:
        raise RuntimeError(f"{selector} is not to be seen")
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, STICK_REACH * box["width"]


def stopped(hand: Hand) -> None:
    """Stop the arm, so that another run can begin; not counted."""
    hand.page.keyboard.press("Escape")
    for _ in range(50):
        if not look(hand.page).enabled:
            return
        time.sleep(0.05)
