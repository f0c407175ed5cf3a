"""The guided practice on the real page with the real arm: each step is ticked off by what the person does."""

import time

import numpy as np
import pytest

from .conftest import press_switch

NEAR_M = 0.1
WITHIN_S = 90.0


@pytest.fixture
def practising(page):
    page.get_by_role("button", name="Practise now").click()
    return page


def done(page):
    return page.locator("#practice-steps li[data-done=true]").count()


def ticks(page, number, within_s=3.0):
    """Whether so many steps are done, in time."""
    end_s = time.monotonic() + within_s
    while time.monotonic() < end_s:
        if done(page) >= number:
            return True
        page.wait_for_timeout(30)
    return False


def hold(page, key, ms):
    page.keyboard.down(key)
    page.wait_for_timeout(ms)
    page.keyboard.up(key)


def away(arm):
    """From the nearest food, m."""
    return min(np.linalg.norm(arm.tool - goal) for goal in arm.goals.values())


def test_keys_alone_tick_every_step_off(practising, arm, press_enable):
    page = practising
    assert done(page) == 0
    page.get_by_role("radio", name="Straight lines").check()
    page.locator("#stick").focus()
    end_s = time.monotonic() + WITHIN_S
    page.keyboard.press("Enter")
    while not ticks(page, 1):
        page.keyboard.press("Enter")
    # A busy computer stops the arm, and then letting go ends no motion.
    while not ticks(page, 4, 0.3):
        assert time.monotonic() < end_s
        if not arm.enabled:
            press_enable(page, arm)
            page.locator("#stick").focus()
        hold(page, "ArrowDown", 600)
    if not arm.enabled:
        press_enable(page, arm)
    assert done(page) == 4
    page.keyboard.press("Escape")
    assert ticks(page, 5)
    assert arm.comes_to(lambda: not arm.enabled, 1.5)
    press_enable(page, arm)
    page.locator("#status-text", has_text="close to some food").wait_for()
    towards_food(page, arm, press_enable, end_s)
    assert ticks(page, 6)
    assert page.locator("#practice-title").inner_text() == "Well done! You can drive the arm."
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Start again").click()
    assert done(page) == 0
    page.get_by_role("button", name="Skip").click()
    assert not page.locator("#practice").is_visible()
    # It is not offered to this person again, and can be begun from the buttons below.
    page.reload()
    page.locator(".label").first.wait_for(state="attached")
    assert not page.locator("#practice").is_visible()
    page.locator("#settings-open").click()
    page.get_by_role("button", name="Practise", exact=True).click()
    assert page.locator("#practice-steps").is_visible()


def towards_food(page, arm, press_enable, end_s):
    """Push whatever brings the tool nearer, until it is near."""
    ways = [(mode, key) for mode in ("1", "2") for key in ("ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight")]
    at = 0
    while away(arm) > NEAR_M:
        assert time.monotonic() < end_s, f"the tool is still {away(arm):.2f} m away"
        mode, key = ways[at % len(ways)]
        if not arm.enabled:
            press_enable(page, arm)
            page.locator("#stick").focus()
        page.keyboard.press(mode)
        page.wait_for_timeout(60)
        before = away(arm)
        hold(page, key, 400)
        page.wait_for_timeout(200)
        if away(arm) > before - 0.005:
            at += 1


def choose(page, choice):
    """Wait until it is lit, and press the switch."""
    page.locator(f"#scan li[data-choice={choice}][aria-current=true]").wait_for(timeout=30_000)
    press_switch(page, "Enter")


def test_one_switch_ticks_its_steps_off_in_its_own_words(practising, arm):
    page = practising
    page.locator("input[name=panel][value=switch]").evaluate("one => one.click()")
    page.locator("#status-text", has_text="Choose Enable with your switch.").wait_for()
    page.locator("#switch").focus()

    end_s = time.monotonic() + WITHIN_S
    while done(page) < 4:
        assert time.monotonic() < end_s
        if not arm.enabled:
            choose(page, "enable")
            arm.comes_to(lambda: arm.enabled, 1.5)
        elif done(page) < 3:
            choose(page, "down")
            ticks(page, 3, 2.0)
            # The press that ends the motion.
            if page.locator("#scan li[data-moving=true]").count():
                press_switch(page, "Enter")
        ticks(page, 4, 0.3)
    while done(page) < 5:
        assert time.monotonic() < end_s
        choose(page, "stop" if arm.enabled else "enable")
        ticks(page, 5, 1.0)
    arm.wait(lambda: not arm.enabled, 1.0)


def test_a_switch_can_begin_and_skip_the_practice(open_page):
    page = open_page()
    page.locator("input[name=panel][value=switch]").evaluate("one => one.click()")
    page.locator("#switch").focus()
    for choice, shown in (("practice-begin", True), ("practice-skip", False)):
        choose(page, "more")
        choose(page, choice)
        page.locator("#practice-steps").wait_for(state="visible" if shown else "hidden")
