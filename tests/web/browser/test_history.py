"""A drive is listed, looked at again, saved as a table, printed on one page, and deleted with undo."""

import csv
import shutil
import subprocess

import pytest
from playwright.sync_api import expect

from .conftest import control_with

NAME = "محمد"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("history")


@pytest.fixture(scope="module")
def served(start_server, place):
    with start_server(place, "--task", "entree") as address:
        yield address


@pytest.fixture
def page(chromium, served, watch):
    context = chromium.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.set_default_timeout(20_000)
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    yield page
    context.close()
    assert errors == []


def driven(page, served, watch, press_enable, press_until_moving, add_person):
    """A person drives for a moment, stops, and goes on to the history."""
    add_person(page, served, NAME)
    with watch(served) as arm:
        arm.wait(lambda: arm.state["driver_name"] == NAME)
        press_enable(page, arm)
        page.locator("#stick").focus()
        down = lambda: page.keyboard.down("ArrowUp")  # noqa: E731
        press_until_moving(page, arm, down, lambda: page.keyboard.up("ArrowUp"))
        page.wait_for_timeout(800)
        page.keyboard.up("ArrowUp")
        page.keyboard.press("Escape")
        arm.comes_to_rest()
        tool = arm.tool
    # The bar of the switches is on every page then; it is not printed.
    control_with(page, "Switch")
    page.goto(f"{served}/history")
    page.locator("#page-switch").wait_for()
    page.get_by_role("button", name="Show: Tofu").first.wait_for()
    return tool


def test_a_drive_is_listed_replayed_printed_and_deleted(
    page, served, watch, place, press_enable, press_until_moving, add_person, wait_in_page, tmp_path
):
    tool = driven(page, served, watch, press_enable, press_until_moving, add_person)
    expect(page.locator("#drives")).to_contain_text("Keyboard")
    expect(page.locator("select[name=person]")).to_have_value(
        page.evaluate("JSON.parse(localStorage['latentarm.person']).id")
    )

    page.evaluate("document.addEventListener('arm-drawn', (e) => { window.drawn = e.detail; })")
    page.get_by_role("button", name="Show: Tofu").first.click()
    wait_in_page(page, "window.drawn")
    page.locator("#seek").fill(page.locator("#seek").get_attribute("max"))
    wait_in_page(
        page,
        "(tool) => window.drawn.tool.every((value, axis) => Math.abs(value - tool[axis]) < 0.005)",
        tool.tolist(),
    )
    page.locator("#seek").fill("0")
    page.get_by_role("button", name="Play").click()
    expect(page.locator("#replay-time")).not_to_contain_text("0.0 s of")
    page.get_by_role("button", name="Pause").click()

    page.locator("select[name=input]").select_option("Keyboard")
    page.locator("input[name=until]").fill("2001-01-01")
    expect(page.locator("#drives-title")).to_have_text("0 drives")
    page.locator("input[name=until]").fill("")
    expect(page.locator("#drives-title")).to_have_text("One drive")

    with page.expect_download() as download:
        page.get_by_role("link", name="Save as a table").click()
    (row,) = csv.DictReader(download.value.path().read_text("utf-8-sig").splitlines())
    assert (row["person"], row["task"], row["inputs"]) == (NAME, "entree", "keyboard")

    page.pdf(path=tmp_path / "report.pdf", prefer_css_page_size=True)
    if shutil.which("pdfinfo"):
        told = subprocess.run(
            ["pdfinfo", tmp_path / "report.pdf"], capture_output=True, text=True, check=True
        )
        assert "Pages:           1" in told.stdout
        words = subprocess.run(
            ["pdftotext", tmp_path / "report.pdf", "-"], capture_output=True, text=True, check=True
        )
        assert "The robot arm is simulated" in words.stdout
        assert "Next choice" not in words.stdout
        assert "press for" not in words.stdout

    page.get_by_role("button", name="Delete: Tofu").first.click()
    expect(page.locator("#drives-title")).to_have_text("0 drives")
    page.get_by_role("button", name="Undo").click()
    expect(page.locator("#drives-title")).to_have_text("One drive")

    person = page.evaluate("JSON.parse(localStorage['latentarm.person']).id")
    page.goto(f"{served}/people")
    page.get_by_role("button", name=f"Delete {NAME}").click()
    page.get_by_role("button", name="Delete everything").click()
    expect(page.get_by_role("button", name=f"Choose {NAME}")).to_have_count(0)
    files = [path for path in place.rglob("*") if path.is_file()]
    for text in (NAME, person):
        assert [path for path in files if text.encode() in path.read_bytes() or text in str(path)] == []
