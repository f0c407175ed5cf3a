"""A person drives to a goal, by every way of pressing that the page has.

The person is simulated: they look at where each direction would take the tool and press the one that ends
nearest to the goal. Everything they do goes through the browser; where the arm is comes from the server.
"""

import time
from contextlib import suppress

import numpy as np
import pytest
from playwright.sync_api import Error

from .conftest import control_with, press_switch

NEAR_M = 0.03
PATIENCE_S = 60.0
NOTICED_S = 1.0
"""A person sees that nothing moves within this."""

SCANNED_MS = 8000.0
"""All choices have been lit within this."""

KEYS = {"up": "ArrowUp", "down": "ArrowDown", "left": "ArrowLeft", "right": "ArrowRight"}
PUSH = {"up": (0, 1), "down": (0, -1), "left": (-1, 0), "right": (1, 0)}
GAMEPAD = """
window.pad = { index: 0, id: "pad", mapping: "standard", connected: true, axes: [0, 0],
  buttons: [{ pressed: false }, { pressed: false }] };
navigator.getGamepads = () => (window.pad ? [window.pad] : [null]);
"""


class Pointer:
    """Drags the stick."""

    def __init__(self, page, drag_stick):
        self.page = page
        self.drag_stick = drag_stick

    def enable(self):
        self.page.get_by_role("button", name="Enable", exact=True).click()

    def push(self, direction):
        right, up = PUSH[direction]
        self.drag_stick(self.page, 0.4 * right, 0.4 * up)

    def let_go(self):
        self.page.mouse.up()


class Keyboard:
    """Tabs to nothing, clicks on nothing: Enter and the arrow keys."""

    def __init__(self, page, _drag_stick):
        self.page = page
        self.down = None
        page.locator("#stick").focus()

    def enable(self):
        self.page.keyboard.press("Enter")

    def push(self, direction):
        self.down = KEYS[direction]
        self.page.keyboard.down(self.down)

    def let_go(self):
        if self.down:
            self.page.keyboard.up(self.down)


class Buttons:
    """Holds the direction buttons."""

    def __init__(self, page, _drag_stick):
        self.page = page
        control_with(page, "Buttons")

    def enable(self):
        self.page.get_by_role("button", name="Enable", exact=True).click()

    def push(self, direction):
        self.page.get_by_role("button", name=direction.capitalize(), exact=True).hover()
        self.page.mouse.down()

    def let_go(self):
        self.page.mouse.up()


class OneSwitch:
    """Has one key, and waits for the light."""

    def __init__(self, page, _drag_stick):
        self.page = page
        page.get_by_role("button", name="Settings").click()
        page.get_by_label("Time on each choice").fill("0.6")
        page.get_by_role("button", name="Done").click()
        control_with(page, "Switch")
        page.get_by_role("button", name="Switch", exact=True).focus()

    def _choose(self, choice):
        # The choices change when the arm stops by itself: then there is nothing to wait for.
        with suppress(Error):
            lit = self.page.locator(f"#scan li[data-choice={choice}][aria-current=true]")
            lit.wait_for(timeout=SCANNED_MS)
            press_switch(self.page, "Enter")

    def enable(self):
        self._choose("enable")

    def push(self, direction):
        self._choose(direction)

    def let_go(self):
        if self.page.locator("#scan li[data-moving=true]").count():
            press_switch(self.page, "Enter")


class Gamepad:
    """Tilts the first stick of a gamepad and presses its first button."""

    def __init__(self, page, _drag_stick):
        self.page = page

    def enable(self):
        self.page.evaluate("pad.buttons[0].pressed = true")
        self.page.wait_for_timeout(250)
        self.page.evaluate("pad.buttons[0].pressed = false")

    def push(self, direction):
        right, up = PUSH[direction]
        self.page.evaluate("axes => { pad.axes = axes; }", [right, -up])

    def let_go(self):
        self.page.evaluate("pad.axes = [0.02, -0.01]")


def best_direction(arm, goal, pushed):
    """What is pushed, as long as it comes nearer; else whose next half second ends nearest to the goal."""

    def left_m(name):
        return np.linalg.norm(np.array(arm.ghosts[name][2]) - goal)

    if pushed is not None and left_m(pushed) < np.linalg.norm(arm.tool - goal):
        return pushed
    return min(arm.ghosts, key=left_m)


def drive(hand, arm, goal):
    """Until the tool is there; whenever the arm has stopped, let go and enable it, as people do."""
    end_s = time.monotonic() + PATIENCE_S
    pushed = None
    while np.linalg.norm(arm.tool - goal) > NEAR_M:
        assert time.monotonic() < end_s, (
            f"{np.linalg.norm(arm.tool - goal):.3f} m away; {arm.state['reason']}"
        )
        if not arm.enabled:
            hand.let_go()
            pushed = None
            time.sleep(0.2)
            hand.enable()
            time.sleep(0.3)
            continue
        best = best_direction(arm, goal, pushed)
        if best != pushed:
            hand.let_go()
            hand.push(best)
            pushed = best
        elif not arm.comes_to(lambda: arm.state["phase"] == "moving" or not arm.enabled, NOTICED_S):
            # Another choice was lit by the time of the press: once more.
            pushed = None
        time.sleep(0.1)
    hand.let_go()


@pytest.mark.parametrize(
    ("hand", "goal"),
    [(Pointer, "carrot"), (Keyboard, "tofu"), (Buttons, "carrot"), (OneSwitch, "carrot"), (Gamepad, "melon")],
)
def test_a_person_drives_to_a_goal(open_page, seat, arm, drag_stick, hand, goal):
    page = seat(open_page(GAMEPAD if hand is Gamepad else ""), arm)
    assert np.linalg.norm(arm.tool - arm.goals[goal]) > 0.2
    drive(hand(page, drag_stick), arm, arm.goals[goal])
    arm.is_let_go()
    assert np.linalg.norm(arm.tool - arm.goals[goal]) < NEAR_M + 0.01
