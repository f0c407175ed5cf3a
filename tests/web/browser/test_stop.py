"""Stop acts on press, on Space and on Escape, from every page; one page drives at a time."""

import pytest
from playwright.sync_api import expect


@pytest.fixture
def moving(enabled, hold_key):
    """A page that holds a key, and so moves the arm."""
    hold_key(enabled)
    return enabled


@pytest.mark.parametrize("key", ["Space", "Escape"])
@pytest.mark.parametrize("focus", ["#stick", "#enable", "#settings-open", "input[name=mode]:checked"])
def test_a_key_stops_the_arm_wherever_the_focus_is(moving, arm, key, focus):
    moving.locator(focus).focus()
    moving.keyboard.press(key)
    arm.comes_to_rest()
    assert moving.locator("dialog[open]").count() == 0


def test_stop_acts_on_press_and_not_on_release(moving, arm):
    moving.locator("#stop").hover()
    moving.mouse.down()
    arm.comes_to_rest()
    moving.mouse.up()


def test_a_watching_page_stops_the_arm_and_cannot_drive_it(moving, arm, open_page):
    watcher = open_page()
    expect(watcher.locator("#driver")).to_contain_text("is driving; you are watching")
    watcher.keyboard.press("Escape")
    arm.comes_to_rest()
    watcher.locator("#stick").focus()
    watcher.keyboard.down("ArrowRight")
    arm.stays()
    watcher.keyboard.up("ArrowRight")


def test_a_watching_page_that_loses_the_focus_does_not_stop_the_arm(moving, arm, open_page):
    watcher = open_page()
    watcher.evaluate("window.dispatchEvent(new Event('blur'))")
    watcher.close()
    arm.wait(lambda: arm.state["watchers"] == 1)
    assert "stop_pressed" not in str(arm.state["reason"])


def test_settings_have_a_stop_of_their_own(enabled, arm):
    enabled.get_by_role("button", name="Settings").click()
    enabled.get_by_role("dialog").get_by_role("button", name="Stop").hover()
    enabled.mouse.down()
    arm.comes_to_rest()
    enabled.mouse.up()


def test_driving_is_handed_over(page, arm, open_page, press_enable, hold_key):
    other = open_page()
    other.get_by_role("button", name="Ask to drive").click()
    page.get_by_role("button", name="Hand over to").click()
    expect(other.locator("#enable")).to_have_text("Enable")
    expect(page.locator("#driver")).to_contain_text("is driving; you are watching")
    press_enable(other, arm)
    hold_key(other)
    other.keyboard.up("ArrowLeft")
    assert "stop_pressed" not in str(arm.state["reason"])


def test_a_stop_right_after_enable_wins(page, arm):
    page.evaluate(
        """() => {
          document.getElementById("enable").click();
          window.dispatchEvent(new KeyboardEvent("keydown", { code: "Escape" }));
        }"""
    )
    assert not arm.comes_to(lambda: arm.enabled, 1.0)
