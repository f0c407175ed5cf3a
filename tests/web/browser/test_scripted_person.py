"""A scripted person who follows only what the page shows eats a marshmallow, with the keyboard."""

import re

import pytest

from .conftest import ask_to_drive, press_switch
from .hands import Keyboard, OneSwitch
from .scripted_person import Person


@pytest.fixture
def address(start_server, tmp_path):
    with start_server(tmp_path, "--task", "marshmallows", "--seed", "1") as address:
        yield address


@pytest.fixture
def arm(watch, address):
    with watch(address) as arm:
        yield arm


# The names of the small view while it is to be seen: on this screen only close to the food.
SMALL_VIEW = """() => {
  window.smallView = new Set();
  const view = document.getElementById("view-side");
  document.addEventListener("arm-drawn", () => {
    if (view.checkVisibility()) smallView.add(view.querySelector("figcaption").innerText);
  });
}"""


def test_what_the_page_shows_is_enough_to_eat(open_page, arm):
    page = open_page(viewport={"width": 1024, "height": 800}, locale="en-GB")
    ask_to_drive(page)
    page.get_by_role("radio", name="Fast").check()
    page.evaluate(SMALL_VIEW)
    said = Person(page, Keyboard(page)).drive()
    assert said.startswith("Done!"), said
    assert arm.state["task"]["outcome"] == "success"
    assert page.locator("#to-go").is_hidden()
    assert page.evaluate("[...smallView]") == ["Close up"]


def test_a_switch_drives_as_far_as_the_sentence_says_by_one_press(open_page, arm):
    page = open_page(OneSwitch.script(), locale="en-GB")
    ask_to_drive(page)
    OneSwitch(page).enable()
    ask = re.compile(r"Choose (\w+) [\d.]+ cm")
    says = page.locator("#status-text", has_text=ask)
    says.wait_for()
    direction = ask.search(says.inner_text())[1]
    page.locator("#scan li[aria-current=true]", has_text=direction).wait_for()
    press_switch(page, "Enter")
    moving = page.locator("#scan li[data-moving=true]")
    moving.wait_for()
    moving.wait_for(state="detached")
    arm.wait(lambda: arm.state["phase"] == "ready")
    page.wait_for_timeout(500)
    left = re.search(rf"{direction} ([\d.]+) cm", page.locator("#to-go li[aria-current=true]").inner_text())
    assert left is None or float(left[1]) < 1.0
