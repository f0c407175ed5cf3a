"""A scripted person who follows only what the page shows eats a marshmallow, with the keyboard."""

import pytest

from .conftest import ask_to_drive
from .hands import Keyboard
from .scripted_person import Person


@pytest.fixture(scope="module")
def address(start_server, tmp_path_factory):
    with start_server(tmp_path_factory.mktemp("eat"), "--task", "marshmallows", "--seed", "1") as address:
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
