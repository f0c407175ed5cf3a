"""The arm drives back to its start from the page, and stops for whatever the person does."""

import re
from contextlib import suppress

import numpy as np
import pytest
from playwright.sync_api import Error, expect

from .conftest import control_with, press_switch

TRIES = 8
SAID = """() => {
  const line = document.getElementById("status-text");
  window.said = [line.textContent];
  new MutationObserver(() => window.said.push(line.textContent)).observe(line, { childList: true });
}"""


@pytest.fixture
def away(page, arm, press_enable):
    """A page whose arm is enabled and some way from its start."""

    def drive_away():
        start = arm.tool
        for _ in range(TRIES):
            press_enable(page, arm)
            page.locator("#stick").focus()
            page.keyboard.down("ArrowUp")
            arm.comes_to(lambda: np.linalg.norm(arm.tool - start) > 0.15 or not arm.enabled, 5.0)
            page.keyboard.up("ArrowUp")
            if np.linalg.norm(arm.tool - start) > 0.1:
                break
        assert not arm.state["at_start"]
        return page

    return drive_away


@pytest.fixture
def on_its_way(away, arm, press_enable):
    """The same, and the arm is on its way back."""

    def set_out():
        page = away()
        for _ in range(TRIES):
            press_enable(page, arm)
            page.locator("#way-back").dispatch_event("click")
            if arm.comes_to(lambda: arm.state["returning"] and arm.state["phase"] == "moving", 1.0):
                return page
        raise AssertionError(arm.state["reason"])

    return set_out


def test_it_drives_back_without_a_jump_and_says_so(on_its_way, arm, drive_back):
    page = on_its_way()
    page.evaluate(SAID)
    steps = []
    before, tick = arm.tool, arm.state["tick"]
    while arm.state["returning"]:
        arm.wait(lambda tick=tick: arm.state["tick"] > tick)
        now, at = arm.tool, arm.state["tick"]
        steps.append(np.linalg.norm(now - before) / (0.01 * (at - tick)))
        before, tick = now, at
    assert len(steps) > 5
    assert max(steps) < 0.3
    # A busy computer may stop the arm before, or at once after.
    if arm.state["at_start"] and arm.enabled:
        page.wait_for_timeout(1000)
        assert "The arm is back at the start." in page.evaluate("said") or not arm.enabled
    drive_back(page, arm)
    expect(page.locator("#way-back")).to_be_disabled()
    expect(page.locator("#way-back-why")).to_have_text("The arm is at the start.")


@pytest.mark.parametrize("ending", ["Space", "ArrowLeft", "settings", "button", "closed"])
def test_whatever_the_person_does_ends_it(on_its_way, arm, ending):
    page = on_its_way()
    if ending == "settings":
        page.locator("#settings-open").click()
    elif ending == "button":
        page.locator("#poses-open").click()
        page.get_by_role("button", name="End the way back").click()
    elif ending == "closed":
        page.close()
    elif ending == "ArrowLeft":
        page.keyboard.down(ending)
    else:
        page.keyboard.press(ending)
    arm.wait(lambda: not arm.state["returning"] and arm.state["phase"] != "moving", 1.5)
    arm.is_let_go()
    if ending == "ArrowLeft":
        page.keyboard.up(ending)


def test_a_button_that_does_nothing_says_why(page, arm, open_page, away):
    button, why = page.locator("#way-back"), page.locator("#way-back-why")
    expect(button).to_be_disabled()
    expect(why).to_have_text("The arm is at the start.")
    watcher = open_page()
    expect(watcher.locator("#way-back-why")).to_have_text("Only the person who drives can do this.")
    away()
    page.keyboard.press("Space")
    expect(why).to_have_text("To go back to the start, press Enable first.")
    expect(button).to_be_disabled()


def test_it_begins_from_the_scan_and_a_press_of_the_switch_ends_it(away, arm, press_enable):
    page = away()
    control_with(page, "Switch")
    page.get_by_role("button", name="Switch", exact=True).focus()

    def choose(name):
        page.locator("#scan li[aria-current=true]", has_text=re.compile(f"^{name}$")).wait_for()
        press_switch(page, "Enter")

    for _ in range(TRIES):
        if not arm.enabled:
            with suppress(Error):
                if page.locator("#scan li", has_text=re.compile("^Back$")).count():
                    choose("Back")
                choose("Enable")
            arm.comes_to(lambda: arm.enabled, 1.5)
            continue
        # Where the arm has stopped meanwhile, it is not offered any more.
        with suppress(Error):
            choose("More …")
            choose("Arm back to start")
        if arm.comes_to(lambda: arm.state["returning"], 1.0):
            break
    expect(page.locator("#scan li")).to_have_text(["Stop"])
    press_switch(page, "Enter")
    arm.comes_to_rest()
