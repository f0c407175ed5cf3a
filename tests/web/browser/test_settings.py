"""What a person likes is kept under their name and changes what a press does."""

import json

import numpy as np
import pytest
from playwright.sync_api import expect

from .conftest import control_with

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
    """A page whose inputs can be looked at, who drives of an enabled arm."""
    page = seat(open_page(SENT), arm)
    press_enable(page, arm)
    return page


@pytest.fixture
def held(person, arm, press_until_moving):
    """What is sent while a key is held."""

    def held(key):
        def press():
            person.locator("#stick").focus()
            person.keyboard.down(key)

        press_until_moving(person, arm, press, lambda: person.keyboard.up(key))
        person.wait_for_timeout(100)
        deflected = [one for one in map(json.loads, person.evaluate("sent")) if any(one["u"])]
        person.keyboard.up(key)
        arm.wait(lambda: arm.state["phase"] != "moving")
        return deflected[-1]

    return held


def settings(page):
    page.get_by_role("button", name="Settings").click()
    return page.get_by_role("dialog")


def test_axes_sensitivity_and_name_are_kept(person, arm, held, press_enable, address):
    assert held("ArrowUp")["u"] == [0, 1]
    dialog = settings(person)
    people = f"{address}/records/people"
    added = person.request.post(people, data={"name": "Ada"}, headers={"origin": address})
    assert added.ok
    dialog.get_by_role("button", name="Done").click()
    dialog = settings(person)
    dialog.locator("#settings-person").select_option("Ada")
    dialog.get_by_label("Swap up and down with left and right").check()
    dialog.get_by_label("How fast a full push moves the arm").fill("0.5")
    dialog.get_by_role("button", name="Done").click()
    arm.wait(lambda: arm.state["driver"] is None or arm.state["driver_name"] == "Ada")
    person.reload()
    expect(person.locator("#driver")).to_have_text("Nobody is driving.")
    press_enable(person, arm)
    assert arm.state["driver_name"] == "Ada"
    assert held("ArrowUp")["u"] == [0.5, 0]


def test_the_last_input_is_neutral(person, held):
    held("ArrowLeft")
    assert json.loads(person.evaluate("sent.at(-1)"))["u"] == [0, 0]


def test_the_tool_goes_where_the_stick_points_in_the_front_view(person, arm, held):
    person.get_by_role("radio", name="Straight lines").check()
    arm.wait(lambda: arm.state["mode"] == "end_effector")
    before = arm.tool
    held("ArrowRight")
    held("ArrowRight")
    moved = arm.tool - before
    # The camera faces the arm: its right is the arm's left, which is +y.
    assert moved[1] > 0.005
    assert moved[1] > 3 * abs(moved[0])


def test_a_step_ends_by_itself(person, arm, press_enable, press_until_moving):
    settings(person).get_by_label("moves the arm one step").check()
    person.get_by_role("button", name="Done").click()
    control_with(person, "Buttons")
    arm.wait(lambda: not arm.enabled)
    press_enable(person, arm)
    before = arm.tool
    press_until_moving(person, arm, person.get_by_role("button", name="Left", exact=True).click, lambda: None)
    arm.wait(lambda: arm.state["phase"] != "moving", 2.0)
    assert np.linalg.norm(arm.tool - before) > 0.005


def test_a_latched_press_goes_on_until_the_next(person, arm, press_enable, press_until_moving):
    settings(person).get_by_role("radio", name="moves the arm until I press again").check()
    person.get_by_role("button", name="Done").click()
    control_with(person, "Buttons")
    arm.wait(lambda: not arm.enabled)
    press_enable(person, arm)
    left = person.get_by_role("button", name="Left", exact=True)
    press_until_moving(person, arm, left.click, lambda: None)
    assert json.loads(person.evaluate("sent.at(-1)"))["latched"] is True
    left.click()
    arm.is_let_go()


def test_two_switches_go_on_and_choose(person, arm):
    settings(person).get_by_label("Two switches").check()
    person.get_by_role("button", name="Done").click()
    control_with(person, "Switch")
    arm.wait(lambda: not arm.enabled)
    lit = person.locator("#scan li[aria-current=true]")
    lit.get_by_text("Enable").wait_for()
    person.wait_for_timeout(1500)
    assert lit.inner_text() == "Enable"
    person.locator("#switch-next").click(delay=80)  # shorter presses do not count
    lit.get_by_text("Other mode").wait_for()
    person.get_by_role("button", name="Switch", exact=True).click(delay=80)
    arm.wait(lambda: arm.state["mode"] == "end_effector")


def test_after_a_click_on_done_enter_enables_and_keys_find_their_place_again(open_page, seat, arm):
    page = seat(open_page(), arm)  # closes Settings by a click
    page.keyboard.press("Enter")
    arm.wait(lambda: arm.enabled)
    expect(page.get_by_role("dialog")).to_be_hidden()
    page.keyboard.press("Escape")
    page.locator("#settings-open").focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("dialog")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.locator("#settings-open")).to_be_focused()
