"""One switch or two reach everything, what is lit is spoken, and Space may be a switch."""

import pytest

from .conftest import control_with, press_switch

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
    control_with(page, "Switch")
    page.get_by_role("button", name="Switch", exact=True).focus()


def two(page):
    page.get_by_role("button", name="Settings").click()
    page.get_by_role("dialog").get_by_label("Two switches").check()
    page.get_by_role("button", name="Done").click()
    control_with(page, "Switch")
    page.get_by_role("button", name="Switch", exact=True).focus()


def offered(page):
    return set(page.locator("#scan li").all_inner_texts())


def choose_by_two(page, name, key="Enter"):
    """Go on until it is lit, and choose it."""
    for _ in range(40):
        if page.locator("#scan li[aria-current=true]").inner_text() == name:
            press_switch(page, key)
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


LIT_IN_SIGHT = """() => {
  const lit = document.querySelector("#scan [aria-current=true]");
  const { left, top, width, height } = lit.getBoundingClientRect();
  return lit.contains(document.elementFromPoint(left + width / 2, top + height / 2));
}"""


@pytest.mark.parametrize("size", [(844, 390), (390, 844), (1280, 720)])
def test_of_a_list_longer_than_its_place_the_lit_choice_is_in_sight(page, arm, size):
    two(page)
    page.set_viewport_size({"width": size[0], "height": size[1]})
    choose_by_two(page, "More …")
    hidden = []
    for _ in range(len(offered(page))):
        if not page.evaluate(LIT_IN_SIGHT):
            hidden.append(page.locator("#scan li[aria-current=true]").inner_text())
        press_switch(page, "Backspace")
    assert hidden == []


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
    key.click()
    page.keyboard.press("Space")
    assert key.input_value() == "Space"
    page.get_by_role("button", name="Done").click()
    assert page.locator("#stop").get_attribute("aria-keyshortcuts") == "Escape"
    press_enable(page, arm)
    page.locator("#scan li[data-choice=up]").wait_for()
    stopped = arm.state["reason"]
    choose_by_two(page, "Up", key="Space")
    arm.wait(lambda: arm.state["phase"] == "moving" or not arm.enabled)
    assert "stop_pressed" not in str((arm.state["reason"] or stopped or {}).get("code"))
    press_enable(page, arm) if not arm.enabled else None
    page.keyboard.press("Escape")
    arm.comes_to_rest()
    assert arm.state["reason"]["code"].startswith("stop_pressed")


def lit(page):
    return page.locator("#scan li[aria-current=true]").inner_text()


def click_next_task(page):
    page.locator("#task-more > summary").click()
    page.locator("#task-next").click()


def open_and_close_settings(page):
    page.get_by_role("button", name="Settings").click()
    page.get_by_role("button", name="Done").click()


def show_more_of_the_task(page):
    page.locator("#task-more > summary").click()


@pytest.mark.parametrize("helper", [click_next_task, open_and_close_settings, show_more_of_the_task])
def test_a_switch_takes_what_is_lit_whatever_a_helper_has_clicked(page, arm, helper):
    scan(page, Time_on_each_choice="1.5")
    helper(page)
    unfolded = page.locator("details[open]").count()
    choose_by_one(page, "More …")
    assert offered(page) >= MORE
    choose_by_one(page, "Back")
    assert offered(page) == {"Enable", "Other mode", "Next task", "More …", "Stop"}
    assert not arm.enabled
    assert page.get_by_role("dialog").count() == 0
    assert page.locator("details[open]").count() == unfolded


def test_settings_that_a_helper_has_opened_are_scanned_and_left_by_the_switch(page):
    two(page)
    page.get_by_role("button", name="Settings").click()
    choose_by_two(page, "Switch timing …")
    assert {"Time on each choice …", "Stop", "Back"} <= offered(page)
    choose_by_two(page, "Back")
    choose_by_two(page, "Done")
    page.get_by_role("dialog").wait_for(state="hidden")
    assert lit(page) == "Enable"


def test_the_menu_of_pages_is_scanned_and_closed_by_the_switch(page):
    two(page)
    page.set_viewport_size({"width": 390, "height": 844})
    page.locator("#pages-open").click()
    page.locator("#pages:popover-open").wait_for()
    assert offered(page) >= {"Teach", "People", "Stop", "Back"}
    choose_by_two(page, "Back")
    page.locator("#pages:popover-open").wait_for(state="hidden")
    assert "Enable" in offered(page)


def test_a_field_keeps_the_switch_only_while_somebody_types_in_it(page):
    two(page)
    page.get_by_role("button", name="Settings").click()
    page.get_by_label("Key to choose").click()
    page.keyboard.press("Space")
    field = page.locator("#record-task")
    field.click()
    page.keyboard.type("a cup")
    assert field.input_value() == "a cup"
    page.wait_for_timeout(5100)
    choose_by_two(page, "Done", key="Space")
    page.get_by_role("dialog").wait_for(state="hidden")
    assert field.input_value() == "a cup"
