"""The whole loop without a terminal: record with the tool's directions, train, drive what was learned."""

import re
import time

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from .conftest import ask_to_drive, set_up

NEAR_M = 0.02
"""So near the tool comes to where it started."""

WAY_M = 0.05
WATCH_PROGRESS = """() => {
  window.said = [];
  const look = () => said.push(document.getElementById("training-text")?.textContent ?? "");
  new MutationObserver(look).observe(document.body, { subtree: true, childList: true, characterData: true });
}"""


# Other tests share a server with a run; this one begins with none and loads one.
@pytest.fixture
def address(start_server, tmp_path):
    with start_server(tmp_path) as address:
        yield address


@pytest.fixture
def arm(watch, address):
    with watch(address) as arm:
        yield arm


def found(page):
    """What axe has to say against the page."""
    violations = Axe().run(page).response["violations"]
    return [(one["id"], [node["html"] for node in one["nodes"]]) for one in violations]


@pytest.fixture
def push(press_until_moving, press_enable):
    """Holds a key until something holds; enables the arm anew where a busy computer has stopped it."""

    def push(page, arm, key, until, within_s=30.0):
        end_s = time.monotonic() + within_s
        page.locator("#stick").focus()
        reached = False
        while not reached and time.monotonic() < end_s:
            if not arm.enabled:
                press_enable(page, arm)
            press_until_moving(page, arm, lambda: page.keyboard.down(key), lambda: page.keyboard.up(key))
            arm.comes_to(lambda: until() or not arm.enabled, within_s)
            reached = until()
            page.keyboard.up(key)
            time.sleep(0.2)
        return reached

    return push


def record(page, arm, push, drive_back, number):
    """One episode by keyboard alone, from the start; the way that the tool went, m."""
    begin = arm.tool
    with set_up(page) as dialog:
        dialog.get_by_role("button", name="Start recording").click()
    arm.wait(lambda: arm.state["recording"] and arm.state["recording"]["on"])
    assert push(page, arm, "ArrowUp", lambda: np.linalg.norm(arm.tool - begin) > 2 * WAY_M)
    page.keyboard.press("Escape")
    arm.comes_to_rest()
    way = arm.tool - begin
    with set_up(page) as dialog:
        dialog.get_by_role("button", name="Stop recording").click()
        expect(page.locator("#record-text")).to_have_text(re.compile(f"^{number} recordings? kept"))
    drive_back(page, arm)
    assert np.linalg.norm(arm.tool - begin) < NEAR_M
    return way


def test_the_arm_learns_on_the_page_what_it_was_shown(open_page, arm, push, drive_back, tmp_path):
    page = open_page()
    ask_to_drive(page)
    page.get_by_role("radio", name="Fast").check()
    assert arm.welcome["run"] is None
    with set_up(page) as dialog:
        dialog.get_by_label("What you are doing").fill("push")
    ways = [record(page, arm, push, drive_back, number) for number in (1, 2, 3)]

    page.locator("#settings-open").click()
    page.get_by_role("link", name="Teach the arm from these").click()
    expect(page.get_by_role("checkbox", name=re.compile("Recording 3: push"))).to_be_checked()
    train = page.get_by_role("button", name="Train", exact=True)
    expect(train).to_be_enabled()
    page.get_by_role("checkbox", name=re.compile("Recording 3")).uncheck()
    expect(train).to_be_disabled()
    page.get_by_role("checkbox", name=re.compile("Recording 3")).check()
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        assert found(page) == []
    page.get_by_label("Name for what it learns").fill("pushing")
    page.get_by_role("radio", name="Left and right only").check()
    page.evaluate(WATCH_PROGRESS)
    train.click()
    expect(page.get_by_role("progressbar")).to_have_attribute(
        "aria-valuenow", re.compile("[1-9]"), timeout=60_000
    )
    expect(page.locator("#training-title")).to_have_text("The arm has learned pushing.", timeout=60_000)
    # It may be over before anybody looks.
    assert any(re.match(r"Pass \d+ of", said) for said in page.evaluate("said"))
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        assert found(page) == []
    expect(page.get_by_label("Name for what it learns")).to_have_value("pushing-1")
    assert (tmp_path / "runs" / "pushing" / "config.json").is_file()

    page.get_by_role("button", name="Drive it", exact=True).click()
    page.wait_for_url(re.compile(r"/$"), timeout=30_000)
    page.locator(".label").first.wait_for(state="attached")
    expect(page.locator("#about")).to_have_text(re.compile("Learned: pushing"))
    arm.wait(lambda: arm.welcome["run"] == "pushing")
    ask_to_drive(page)
    page.get_by_role("radio", name="Learned motions").check()
    arm.wait(lambda: arm.state["mode"] in ("latent", "assisted"))
    shown = np.mean([way / np.linalg.norm(way) for way in ways], axis=0)
    # Nobody knows which way a learned axis has come to point: the person tries.
    for key in ("ArrowRight", "ArrowLeft"):
        before = arm.tool
        push(page, arm, key, lambda before=before: np.linalg.norm(arm.tool - before) > WAY_M, 10.0)
        if (arm.tool - before) @ shown > 0:
            break
    moved = arm.tool - before
    assert np.linalg.norm(moved) > 0.8 * WAY_M
    # Along what was shown, and not just anywhere.
    assert moved @ shown > 0.8 * np.linalg.norm(moved)
    arm.is_let_go()


def test_what_cannot_be_trained_is_said(open_page, arm):
    page = open_page()
    page.get_by_role("link", name="Teach").click()
    page.get_by_text("Nothing yet.").wait_for()
    expect(page.get_by_role("button", name="Train", exact=True)).to_be_disabled()
    for size in ((1280, 800), (390, 844), (320, 640)):
        page.set_viewport_size({"width": size[0], "height": size[1]})
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_teach_leads_to_the_recorder(open_page):
    page = open_page()
    page.get_by_role("link", name="Teach").click()
    page.get_by_role("link", name="Record on the Drive page").click()
    expect(page.locator("#recording")).to_be_focused()
    expect(page.get_by_role("button", name="Start recording")).to_be_in_viewport()
