"""What a person likes is kept under their name and changes what a press does."""

import json

import numpy as np
import pytest

SENT = """
window.sent = [];
const send = WebSocket.prototype.send;
WebSocket.prototype.send = function (text) {
  if (typeof text === "string" && text.includes('"input"')) window.sent.push(text);
  return send.call(this, text);
};
"""


@pytest.fixture
def person(open_page, seat, arm, press_enable):
    """A page whose inputs can be looked at, at the wheel of an enabled arm."""
    page = seat(open_page(SENT), arm)
    press_enable(page, arm)
    return page


def held(page, key):
    """What is sent while a key is held."""
    page.locator("#stick").focus()
    page.keyboard.down(key)
    page.wait_for_timeout(150)
    last = json.loads(page.evaluate("sent.at(-1)"))
    page.keyboard.up(key)
    page.wait_for_timeout(100)
    return last


def settings(page):
    page.get_by_role("button", name="Settings").click()
    return page.get_by_role("dialog")


def test_axes_sensitivity_and_name_are_kept(person, arm, press_enable):
    assert held(person, "ArrowUp")["u"] == [0, 1]
    dialog = settings(person)
    dialog.get_by_label("Name").fill("Ada")
    dialog.get_by_label("Name").press("Tab")
    dialog.get_by_label("Swap the two axes").check()
    dialog.get_by_label("Sensitivity").fill("0.5")
    dialog.get_by_role("button", name="Done").click()
    arm.wait(lambda: arm.state["driver"] is None or arm.state["driver_name"] == "Ada")
    person.reload()
    person.get_by_text("Nobody is driving").wait_for()
    press_enable(person, arm)
    assert arm.state["driver_name"] == "Ada"
    assert held(person, "ArrowUp")["u"] == [0.5, 0]


def test_the_last_input_is_neutral(person):
    held(person, "ArrowLeft")
    assert json.loads(person.evaluate("sent.at(-1)"))["u"] == [0, 0]


def test_the_tool_goes_where_the_stick_points_in_the_front_view(person, arm, press_enable):
    person.get_by_role("radio", name="Tool directions").check()
    arm.wait(lambda: arm.state["mode"] == "end_effector")
    if not arm.enabled:
        press_enable(person, arm)
    before = arm.tool
    person.locator("#stick").focus()
    person.keyboard.down("ArrowRight")
    arm.wait(lambda: np.linalg.norm(arm.tool - before) > 0.03)
    person.keyboard.up("ArrowRight")
    moved = arm.tool - before
    # The camera faces the arm: its right is the arm's left, which is +y.
    assert moved[1] > 3 * abs(moved[0])


def test_a_step_ends_by_itself(person, arm, press_enable):
    settings(person).get_by_label("moves the arm one step").check()
    person.get_by_role("button", name="Done").click()
    person.get_by_role("radio", name="Buttons").check()
    arm.wait(lambda: not arm.enabled)
    press_enable(person, arm)
    before = arm.tool
    person.get_by_role("button", name="Left", exact=True).click()
    arm.wait(lambda: arm.state["phase"] == "moving")
    arm.wait(lambda: arm.state["phase"] != "moving", 2.0)
    assert np.linalg.norm(arm.tool - before) > 0.005


def test_a_latched_press_goes_on_until_the_next(person, arm, press_enable):
    settings(person).get_by_label("moves the arm until I press again").check()
    person.get_by_role("button", name="Done").click()
    person.get_by_role("radio", name="Buttons").check()
    arm.wait(lambda: not arm.enabled)
    press_enable(person, arm)
    left = person.get_by_role("button", name="Left", exact=True)
    left.click()
    arm.wait(lambda: arm.state["phase"] == "moving")
    assert json.loads(person.evaluate("sent.at(-1)"))["latched"] is True
    left.click()
    arm.wait(lambda: arm.state["phase"] != "moving", 1.0)
    arm.stays()
