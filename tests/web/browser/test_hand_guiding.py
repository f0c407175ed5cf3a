"""A real arm in the browser: guided by hand from Teach, lost and connected again."""

import os

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from wooden_server import wooden_server

from latentarm.robots.panda import panda

PHONE = {"width": 390, "height": 844}


def found(page):
    """What axe has to say against the page."""
    violations = Axe().run(page).response["violations"]
    return [(one["id"], [node["html"] for node in one["nodes"]]) for one in violations]


@pytest.fixture(scope="module")
def arm():
    with wooden_server(panda()) as server:
        yield server


@pytest.fixture(scope="module")
def real(start_server, arm, tmp_path_factory):
    path = os.pathsep.join(["tests/stand_ins", os.environ.get("PYTHONPATH", "")])
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", path)
        # The stand-in tells its limits, which are the model's.
        words = ("--arm", arm.address, "--robot", "panda")
        with start_server(tmp_path_factory.mktemp("real"), *words) as address:
            yield address


@pytest.fixture
def teach(chromium, real):
    page = chromium.new_page(locale="en", viewport=PHONE)
    page.goto(f"{real}/teach")
    page.locator("#guiding").wait_for()
    yield page
    page.close()


def begin(page):
    page.get_by_label("somebody holds the arm").check()
    page.get_by_role("button", name="Guide by hand").click()
    page.get_by_role("button", name="End guiding").wait_for()
    page.get_by_text("The arm follows your hands").wait_for()


def test_a_motion_is_shown_by_hand_and_recorded(teach, arm):
    page = teach
    assert page.locator("#guiding-begin").get_attribute("aria-disabled") == "true"
    begin(page)
    page.get_by_label("What you are doing").fill("wave")
    page.get_by_role("button", name="Start recording").click()
    page.get_by_text("Recording 1").wait_for()
    for _ in range(50):
        arm.push(np.full(7, 0.01))
        page.wait_for_timeout(20)
    page.get_by_role("button", name="Close gripper").click()
    page.wait_for_timeout(1500)
    assert arm._arm.read().gripper.width_m < 0.07
    assert found(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.get_by_role("button", name="Stop recording").click()
    page.get_by_label("Recording 1: wave").wait_for()
    page.locator("#guiding-task").blur()
    page.keyboard.press("Space")
    page.get_by_role("button", name="Guide by hand").wait_for()
    page.wait_for_timeout(300)
    assert not arm.guiding


def test_leaving_the_page_ends_guiding(teach, real, arm):
    begin(teach)
    assert arm.guiding
    teach.goto(f"{real}/history")
    teach.wait_for_timeout(500)
    assert not arm.guiding


def test_a_lost_arm_is_connected_again(chromium, real, arm):
    page = chromium.new_page(locale="en", viewport=PHONE)
    page.goto(real)
    page.locator("#status-text", has_text="Press Enable").wait_for()  # the arm is there
    arm.cut()
    try:
        page.get_by_role("button", name="Connect again").wait_for()
        assert found(page) == []
    finally:
        arm.repair()
    page.get_by_role("button", name="Connect again").click()
    page.locator("#lost").wait_for(state="hidden")
    assert arm._arm.status().phase == "disabled"
    page.close()
