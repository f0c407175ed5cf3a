"""One switch or two reach everything, what is lit is spoken, and Space may be a switch."""

import pytest

from .conftest import press_switch

SPEECH = """
window.spoken = [];
Object.defineProperty(window, "speechSynthesis", { value: {
  cancel() {}, speak(one) { window.spoken.push([one.text, one.lang, one.volume]); },
} });
window.SpeechSynthesisUtterance = class { constructor(text) { this.text = text; } };
"""
MORE = {"Back", "Help from the robot …", "Settings …", "Other page …", "Start recording", "Stop"}
PATIENCE_MS = 30_000
"""Twice as long as the light takes to go once round the longest list."""


def scan(page, **settings):
    """Choose the settings of a switch user, and steer with the switch."""
    page.get_by_role("button", name="Settings").click()
    dialog = page.get_by_role("dialog")
    for label, value in settings.items():
        dialog.get_by_label(label.replace("_", " ")).fill(value)
    page.get_by_role("button", name="Done").click()
    page.get_by_role("radio", name="Switch", exact=True).check()
    page.get_by_role("button", name="Switch", exact=True).focus()


def two(page):
    page.get_by_role("button", name="Settings").click()
    page.get_by_role("dialog").get_by_label("Two switches").check()
    page.get_by_role("button", name="Done").click()
    page.get_by_role("radio", name="Switch", exact=True).check()
    page.get_by_role("button", name="Switch", exact=True).focus()


def offered(page):
    return set(page.locator("#scan li").all_inner_texts())


def choose_by_two(page, name):
    """Go on until it is lit, and choose it."""
    for _ in range(40):
        if page.locator("#scan li[aria-current=true]").inner_text() == name:
            press_switch(page, "Enter")
            page.wait_for_timeout(150)
            return
        press_switch(page, "Backspace")
    raise AssertionError(f"{name} is never lit: {offered(page)}")


def choose_by_one(page, name):
    """Wait until it is lit, and press."""
    lit = page.locator("#scan li[aria-current=true]", has_text=name)
    lit.wait_for(timeout=PATIENCE_MS)
    press_switch(page, "Enter")
    page.wait_for_timeout(150)


@pytest.mark.parametrize("choose", [choose_by_one, choose_by_two])
def test_switches_reach_help_settings_and_pages(page, arm, choose):
    if choose is choose_by_two:
        two(page)
    else:
        scan(page, Time_on_each_choice="1.5")
    choose(page, "More …")
    assert offered(page) >= MORE
    choose(page, "Help from the robot …")
    assert offered(page) == {"Off", "Low", "✓ Medium", "High", "Stop", "Back"}
    choose(page, "High")
    arm.wait(lambda: arm.state["help"] == "high")
    choose(page, "More …")
    choose(page, "Settings …")
    assert {"Switches …", "Switch timing …", "Stick …", "Back"} <= offered(page)
    choose(page, "Back")
    assert offered(page) >= MORE
    choose(page, "Other page …")
    choose(page, "Personalise")
    page.wait_for_url("**/personalise*")
    page.locator("#scan li", has_text="Begin").wait_for()


def test_what_is_lit_is_spoken(open_page, seat, arm):
    page = seat(open_page(SPEECH), arm)
    two(page)
    page.get_by_role("button", name="Settings").click()
    page.get_by_label("Say out loud what is lit").check()
    page.get_by_label("How loud").fill("0.5")
    page.get_by_role("button", name="Done").click()
    page.get_by_role("button", name="Switch", exact=True).focus()
    page.evaluate("spoken.length = 0")
    for _ in range(3):
        press_switch(page, "Backspace")
    assert page.evaluate("spoken") == [[text, "en", 0.5] for text in ("Other mode", "Next task", "More …")]


def test_space_as_a_switch_does_not_stop_and_escape_does(page, arm, press_enable):
    two(page)
    page.get_by_role("button", name="Settings").click()
    key = page.get_by_label("Key to choose")
    key.focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Space")
    assert key.input_value() == "Space"
    page.get_by_role("button", name="Done").click()
    assert page.locator("#stop").get_attribute("aria-keyshortcuts") == "Escape"
    press_enable(page, arm)
    page.locator("#scan li[data-choice=up]").wait_for()
    stopped = arm.state["reason"]
    press_switch(page, "Backspace")
    press_switch(page, "Space")
    arm.wait(lambda: arm.state["phase"] == "moving" or not arm.enabled)
    assert "stop_pressed" not in str((arm.state["reason"] or stopped or {}).get("code"))
    press_enable(page, arm) if not arm.enabled else None
    page.keyboard.press("Escape")
    arm.comes_to_rest()
    assert arm.state["reason"]["code"].startswith("stop_pressed")
