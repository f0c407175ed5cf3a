"""A person picks a cup up and sets it down again, by every way of pressing that can do it alone.

The hand is about the cup at first. Everything that the person does goes through the browser; where the cup is
comes from the server, as every page is told. On a busy computer the arm stops now and then: what it holds
stays held, and a person enables it again.
"""

import time
from contextlib import suppress

import numpy as np
import pytest
from playwright.sync_api import Error

from .conftest import ask_to_drive, control_with, press_switch

GAMEPAD = """
const buttons = [0, 1, 2, 3].map(() => ({ pressed: false }));
window.pad = { index: 0, id: "pad", mapping: "standard", connected: true, axes: [0, 0], buttons };
navigator.getGamepads = () => [window.pad];
"""
UP, STILL, DOWN = 1, 0, -1
LIFTED_M = 0.06
DROP_M = 0.004
PATIENCE_S = 120.0
TRIES = 8


@pytest.fixture(scope="module")
def address(serve_task):
    with serve_task("cup_at_hand", "cup_task:CupAtHand", "--arm", "mujoco") as address:
        yield address


@pytest.fixture(scope="module")
def arm(watch, address):
    with watch(address) as arm:
        yield arm


class Keyboard:
    """Enter, 2 for height, G and the arrow keys."""

    def __init__(self, page):
        self.page = page
        self.down = None
        page.locator("#stick").focus()

    def enable(self):
        self.page.keyboard.press("Enter")

    def steer_height(self):
        self.page.keyboard.press("2")

    def grip(self):
        self.page.keyboard.press("g")

    def push(self, way):
        self.let_go()
        self.down = "ArrowUp" if way == UP else "ArrowDown"
        self.page.keyboard.down(self.down)

    def let_go(self):
        if self.down:
            self.page.keyboard.up(self.down)
            self.down = None


class Gamepad:
    """The first stick of a gamepad, its first button and its third; the pair of axes is chosen beforehand."""

    def __init__(self, page):
        self.page = page

    def _press(self, number):
        self.page.evaluate("number => { pad.buttons[number].pressed = true; }", number)
        self.page.wait_for_timeout(200)
        self.page.evaluate("number => { pad.buttons[number].pressed = false; }", number)
        self.page.wait_for_timeout(150)

    def enable(self):
        self._press(0)

    def steer_height(self):
        self.page.get_by_role("radio", name="Height, turn").check()

    def grip(self):
        self._press(2)

    def push(self, way):
        self.page.evaluate("up => { pad.axes = [0, -up]; }", way)

    def let_go(self):
        self.push(STILL)


class OneSwitch:
    """One key, and patience for the light."""

    def __init__(self, page):
        self.page = page
        page.get_by_role("button", name="Settings").click()
        page.get_by_label("Time on each choice").fill("0.6")
        page.get_by_role("button", name="Done").click()
        control_with(page, "Switch")
        page.get_by_role("button", name="Switch", exact=True).focus()

    def _choose(self, choice):
        # A press that came late may have begun another motion: the light waits until that is ended.
        self.let_go()
        # The choices change when the arm stops by itself: then there is nothing to wait for.
        with suppress(Error):
            self.page.locator(f"#scan li[data-choice={choice}][aria-current=true]").wait_for(timeout=12_000)
            press_switch(self.page, "Enter")

    def enable(self):
        self._choose("enable")

    def steer_height(self):
        self._choose("mode")

    def grip(self):
        self._choose("gripper")

    def push(self, way):
        self._choose("up" if way == UP else "down")

    def let_go(self):
        if self.page.locator("#scan li[data-moving=true]").count():
            press_switch(self.page, "Enter")


def height(arm):
    """Of the cup, m."""
    return arm.things["poses"][0][2]


def enabled(hand, arm):
    end_s = time.monotonic() + PATIENCE_S
    while not arm.enabled:
        assert time.monotonic() < end_s, arm.state["reason"]
        hand.let_go()
        hand.enable()
        arm.comes_to(lambda: arm.enabled, 1.5)


def grip(hand, arm, until, *, closing):
    """Until then: fingers that stopped with the arm are told again."""
    for _ in range(TRIES):
        enabled(hand, arm)
        hand.grip()
        told = arm.comes_to(lambda: arm.state["gripper"]["closing"] is closing, 1.5)
        if told and arm.comes_to(lambda: until() or not arm.enabled, 8.0) and until():
            return
    raise AssertionError(f"the gripper never does it: {arm.state['gripper']}")


def move(hand, arm, way, until):
    """Push until then, and let go."""
    end_s = time.monotonic() + PATIENCE_S
    while not until():
        assert time.monotonic() < end_s, (height(arm), arm.state["reason"])
        enabled(hand, arm)
        hand.push(way)
        arm.comes_to(lambda: until() or not arm.enabled, 5.0)
        hand.let_go()
    arm.wait(lambda: arm.state["phase"] not in ("moving", "stopping"), 1.0)


@pytest.mark.parametrize("hand_of", [Keyboard, Gamepad, OneSwitch])
def test_a_person_picks_a_cup_up_and_sets_it_down(open_page, arm, hand_of):
    page = open_page(GAMEPAD if hand_of is Gamepad else "")
    arm.start_again()
    ask_to_drive(page)
    page.get_by_role("radio", name="Fast").check()
    page.get_by_role("radio", name="Across").check()
    arm.wait(lambda: arm.state["axes"] == 0)
    arm.wait(lambda: arm.state["gripper"]["closing"] is None and abs(height(arm)) < 1e-3)
    start = np.array(arm.things["poses"][0])
    said = page.locator("#gripper-state")
    said.get_by_text("Open, 80 mm.").wait_for()

    hand = hand_of(page)
    enabled(hand, arm)
    while arm.state["axes"] != 1:
        hand.steer_height()
        arm.comes_to(lambda: arm.state["axes"] == 1, 1.5)
    grip(hand, arm, lambda: arm.state["gripper"]["holding"], closing=True)
    said.get_by_text("Holding something").wait_for()
    move(hand, arm, UP, lambda: height(arm) > LIFTED_M)
    assert arm.state["gripper"]["holding"]
    lean = np.linalg.norm(arm.things["poses"][0][4:6])  # sine of half the angle from upright
    assert lean < 0.1
    move(hand, arm, DOWN, lambda: height(arm) < DROP_M)
    grip(hand, arm, lambda: arm.state["gripper"]["width_m"] > 0.07, closing=False)
    said.get_by_text("Open, ").wait_for()
    tool = arm.tool
    move(hand, arm, UP, lambda: arm.tool[2] > tool[2] + 0.05)
    end = np.array(arm.things["poses"][0])
    assert np.abs(end[:3] - start[:3]).max() < 0.01
    assert not arm.state["gripper"]["holding"]
