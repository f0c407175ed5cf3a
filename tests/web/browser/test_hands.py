"""Ways of pressing and of sitting there, each seen by what the arm does."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import expect

from latentarm.alignment.answers import Answers
from latentarm.alignment.profile import new_profile_folder
from latentarm.models.estimators import load_model
from latentarm.runs.aligning import alignable, learn

from .conftest import control_with, press_switch, set_up

SWITCH_KEY, NEXT_KEY = "Enter", "Backspace"
FAR_M = 0.02
TRIES = 6
"""A busy computer stops the arm now and then; a person presses again."""


@pytest.fixture
def go(arm, press_until_moving):
    """Press, again where a busy computer has stopped the arm, until the tool is 2 cm away; its way, m."""

    def go(page, press, let_go):
        for _ in range(TRIES):
            before = arm.tool
            press_until_moving(page, arm, press, let_go)
            if arm.comes_to(lambda start=before: np.linalg.norm(arm.tool - start) > FAR_M, 2.0):
                return arm.tool - before
            let_go()
        raise AssertionError(f"the arm does not get anywhere: {arm.state['reason']}")

    return go


@pytest.fixture
def way(arm, go):
    """The way of the tool while a key is held, m."""

    def way(page, key):
        def press():
            page.locator("#stick").focus()
            page.keyboard.down(key)

        found = go(page, press, lambda: page.keyboard.up(key))
        page.keyboard.up(key)
        arm.is_let_go()
        return found

    return way


def settle(page, arm, press_enable, *labels):
    """Set what stands in the settings, and enable."""
    page.get_by_role("button", name="Settings").click()
    for label in labels:
        page.get_by_role("dialog").locator("input").and_(page.get_by_label(label)).check()
    page.get_by_role("button", name="Done").click()
    arm.wait(lambda: not arm.enabled)
    press_enable(page, arm)


def test_swapped_axes_turn_the_way_of_the_tool(page, arm, press_enable, way):
    page.get_by_role("radio", name="Straight lines").check()
    arm.wait(lambda: arm.state["mode"] == "end_effector")
    press_enable(page, arm)
    sideways = way(page, "ArrowRight")
    assert sideways[1] > 0.01 > abs(sideways[0])
    page.keyboard.press("Escape")
    settle(page, arm, press_enable, "Swap up and down with left and right")
    along = way(page, "ArrowRight")
    assert abs(along[0]) > 0.01 > abs(along[1])


def test_a_latched_press_moves_the_arm_until_the_next(page, arm, press_enable, go):
    settle(page, arm, press_enable, "moves the arm until I press again")
    control_with(page, "Buttons")
    if not arm.comes_to(lambda: arm.enabled, 0.5):
        press_enable(page, arm)
    left = page.get_by_role("button", name="Left", exact=True)
    # Nothing is held, and the arm goes on.
    go(page, left.click, lambda: None)
    left.click()
    arm.is_let_go()


def test_two_switches_drive_the_arm(page, arm):
    page.get_by_role("button", name="Settings").click()
    page.get_by_role("dialog").get_by_label("Two switches").check()
    page.get_by_role("button", name="Done").click()
    control_with(page, "Switch")
    lit = page.locator("#scan li[aria-current=true]")

    def choose(name):
        # What there is to choose from changes when the arm is enabled, and when it has stopped.
        for _ in range(8):
            if lit.inner_text() == name:
                press_switch(page, SWITCH_KEY)
                return
            press_switch(page, NEXT_KEY)

    def drive():
        if not arm.enabled:
            choose("Enable")
            arm.comes_to(lambda: arm.enabled, 1.5)
            page.wait_for_timeout(200)
        before = arm.tool
        choose("Left")
        return arm.comes_to(lambda: np.linalg.norm(arm.tool - before) > FAR_M, 2.0)

    page.get_by_role("button", name="Switch", exact=True).focus()
    assert any(drive() for _ in range(TRIES)), arm.state["reason"]
    press_switch(page, SWITCH_KEY)
    arm.is_let_go()


def test_after_handing_over_the_other_drives_and_this_one_does_not(page, arm, open_page, press_enable, way):
    press_enable(page, arm)
    way(page, "ArrowLeft")
    other = open_page()
    other.get_by_role("button", name="Ask to drive").click()
    page.get_by_role("button", name="Hand over to").click()
    expect(other.locator("#enable")).to_have_text("Enable")
    arm.comes_to_rest()
    press_enable(other, arm)
    page.locator("#stick").focus()
    page.keyboard.down("ArrowLeft")
    arm.stays()
    page.keyboard.up("ArrowLeft")
    way(other, "ArrowRight")


class TestProfile:
    """Mia, a simulated person, means left by right."""

    @pytest.fixture
    def address(self, start_server, trained, tmp_path):
        run = Path(shutil.copytree(trained, tmp_path / "run"))
        scene = (asked := alignable(run)).scene
        motions = scene.candidates
        action = (motions.end - motions.start) / motions.duration_s
        z = load_model(run).encode(motions.context, action)[asked.seed_index]
        answers = Answers(motions, np.clip(z, -1.0, 1.0) * [-1.0, 1.0])
        learn(asked, answers, "mia", "simulated person").save(new_profile_folder(run, "mia"))
        with start_server(tmp_path, str(run)) as address:
            yield address

    @pytest.fixture
    def arm(self, watch, address):
        with watch(address) as arm:
            yield arm

    def test_a_chosen_profile_turns_the_stick_round(self, page, arm, press_enable, drive_back, way):
        with set_up(page) as dialog:
            dialog.get_by_role("group", name="Help from the robot").get_by_role("radio", name="Off").check()
        arm.wait(lambda: arm.state["mode"] == "latent")
        press_enable(page, arm)
        plain = way(page, "ArrowLeft")
        page.keyboard.press("Escape")
        arm.comes_to_rest()
        drive_back(page, arm)
        page.get_by_role("button", name="Settings").click()
        page.get_by_role("dialog").get_by_label("Your directions").select_option("mia")
        page.get_by_role("button", name="Done").click()
        arm.wait(lambda: arm.state["profile"] == "mia")
        press_enable(page, arm)
        mirrored = way(page, "ArrowLeft")
        assert plain @ mirrored < -0.9 * np.linalg.norm(plain) * np.linalg.norm(mirrored)
