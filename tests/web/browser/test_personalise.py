"""A simulated person says with the stick what they mean, and drives as they mean it afterwards."""

import re
import shutil
from math import cos, radians, sin
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from latentarm.alignment.demonstrated import demonstrated_motions
from latentarm.runs.asking import FASTEST
from latentarm.runs.folder import read_run, robot_of

from .conftest import ask_to_drive, set_up

REACH = 96 / 264
"""From the middle of the stick's drawing to its edge, as a share of the drawing."""

PATIENCE_MS = 90_000
"""Learning takes seconds, on a busy computer more."""

QUESTIONS = 8

WAY_M = 0.05

GAMEPAD = """
window.pad = { index: 0, id: "pad", mapping: "standard", connected: true, axes: [0, 0],
  buttons: [{ pressed: false }, { pressed: false }] };
navigator.getGamepads = () => [window.pad];
"""


@pytest.fixture
def run(trained, tmp_path):
    """A run of the test's own: profiles are kept in it."""
    return Path(shutil.copytree(trained, tmp_path / "run"))


@pytest.fixture
def address(start_server, run, tmp_path):
    with start_server(tmp_path, str(run)) as address:
        yield address


@pytest.fixture
def arm(watch, address):
    with watch(address) as arm:
        yield arm


@pytest.fixture
def person(run):
    """Simulated: means the two main directions of the tool on a stick turned by 60 degrees and mirrored."""
    known = read_run(run)
    motions = demonstrated_motions(known.dataset(), 10**9, np.random.default_rng(0))
    chain = robot_of(known).chain
    moved = chain.forward(motions.end).position - chain.forward(motions.start).position
    main = np.linalg.svd(moved, full_matrices=False)[2][:2]
    main *= np.sign(main[np.arange(2), np.abs(main).argmax(axis=1)])[:, None]
    speed_m_s = np.quantile(np.abs(moved @ main.T).max(axis=1), FASTEST) / motions.duration_s
    turn = radians(60.0)
    directions = np.array([[cos(turn), sin(turn)], [sin(turn), -cos(turn)]]) @ main
    return SimpleNamespace(directions=directions, speed_m_s=speed_m_s)


def found(page):
    """What axe has to say against the page, in light and in dark."""
    said = []
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        expect(page.locator("html")).to_have_attribute("data-theme", scheme)
        violations = Axe().run(page).response["violations"]
        said += [(scheme, one["id"], [node["html"] for node in one["nodes"]]) for one in violations]
    return said


def meant(person, motion):
    """What the person would push for a motion that they see: by where its tool goes."""
    way = np.array(motion["tools"][0])
    along = person.directions @ (way[-1] - way[0])
    return np.clip(along / (person.speed_m_s * motion["duration_s"]), -1, 1)


def answer(page, drag, u):
    drag(page, REACH * u[0], REACH * u[1])
    page.mouse.up()
    page.get_by_role("button", name="This is my answer").click()


def says_left(page):
    expect(page.locator("#answer")).to_have_text("Your answer: left 100 %")


def by_buttons(page):
    page.get_by_role("radio", name="Buttons").check()
    page.get_by_role("button", name="Left", exact=True).click(delay=100)
    says_left(page)
    page.get_by_role("heading", name="Question 1").focus()
    page.keyboard.press("Enter")


ROUND_MS = 40_000
"""Twice as long as the light takes to go once round the choices."""


def by_one_switch(page):
    # Long enough for a press on a busy computer to arrive while its choice is still lit.
    page.get_by_role("button", name="Settings").click()
    page.get_by_label("Time on each choice").fill("2")
    page.get_by_role("button", name="Done").click()
    page.get_by_role("radio", name="Switch").check()
    lit = page.locator("#scan li[aria-current=true]")
    switch = page.get_by_role("button", name="Switch", exact=True)

    def press():
        page.wait_for_timeout(220)
        switch.click(delay=80)

    lit.get_by_text("Left").wait_for(timeout=ROUND_MS)
    press()
    says_left(page)
    press()
    lit.get_by_text("This is my answer").wait_for(timeout=ROUND_MS)
    says_left(page)
    press()


def by_gamepad(page):
    # Where switches answer, a gamepad's first button is one.
    page.get_by_role("radio", name="Stick").check()
    page.wait_for_timeout(250)  # it counts once it has been seen at rest
    page.evaluate("pad.axes = [-1, 0]")
    says_left(page)
    for way in (-0.6, -0.2, 0):
        page.evaluate("way => { pad.axes = [way, 0]; }", way)
        page.wait_for_timeout(40)
    says_left(page)
    page.evaluate("pad.buttons[0].pressed = true")
    page.wait_for_timeout(100)
    page.evaluate("pad.buttons[0].pressed = false")


def question(page, arm, number):
    """The motion of a question, once page and server show it; None where enough is known by then."""
    heading = page.get_by_role("heading", name=re.compile(f"^(Question {number} of|Learning|The robot has)"))
    expect(heading).to_be_visible(timeout=PATIENCE_MS)
    if not heading.inner_text().startswith("Question"):
        return None
    arm.wait(lambda: (arm.learning["personalise"] or {}).get("number") == number)
    return arm.learning["personalise"]["motion"]


def straightness(page, arm, person, drag, press_until_moving, press_enable, drive_back):
    """The cosine between the way of the tool from its start and what the person means by up."""
    page.get_by_role("radio", name="Learned motions").check()
    page.get_by_role("radio", name="Fast").check()
    with set_up(page) as dialog:
        dialog.get_by_role("group", name="Help from the robot").get_by_role("radio", name="Off").check()
    arm.wait(lambda: arm.state["mode"] == "latent")
    drive_back(page, arm)
    begin = arm.tool
    # A busy computer keeps inputs waiting, and the arm stops then: whoever drives enables it again.
    for _ in range(8):
        press_enable(page, arm)
        press_until_moving(page, arm, lambda: drag(page, 0, 0.4), page.mouse.up)
        arm.comes_to(lambda: np.linalg.norm(arm.tool - begin) > WAY_M or not arm.enabled, 8.0)
        page.mouse.up()
        if np.linalg.norm(arm.tool - begin) > WAY_M:
            break
    page.keyboard.press("Escape")
    arm.comes_to_rest()
    way = arm.tool - begin
    return float(way @ person.directions[1] / np.linalg.norm(way))


def test_a_person_is_asked_and_the_arm_does_what_they_mean(
    open_page, arm, person, drag_stick, press_until_moving, press_enable, drive_back, run
):
    page = open_page(GAMEPAD)
    ask_to_drive(page)
    hands = (person, drag_stick, press_until_moving, press_enable, drive_back)
    before = straightness(page, arm, *hands)
    drive_back(page, arm)

    page.get_by_role("link", name="Personalise").click()
    begin = page.get_by_role("button", name="Begin")
    begin.wait_for()
    assert found(page) == []
    page.get_by_label("Your name").fill("...")
    begin.click()
    expect(page.get_by_role("alert")).to_contain_text("type a name")
    page.get_by_label("Your name").fill("ada")
    page.get_by_label("Number of motions, at most").select_option(str(QUESTIONS))
    begin.click()
    page.get_by_role("heading", name="Getting ready").wait_for()
    assert found(page) == []

    stands = arm.tool
    motion = question(page, arm, 1)
    expect(page.get_by_role("status")).to_contain_text("ada is answering questions")
    for panel in ("Buttons", "Switch", "Stick"):
        page.get_by_role("radio", name=panel).check()
        assert found(page) == []
    # Each time taken back, as after a slip.
    for hand in (by_buttons, by_one_switch, by_gamepad):
        hand(page)
        question(page, arm, 2)
        page.get_by_role("button", name="Back", exact=True).click()
        assert question(page, arm, 1) == motion
    page.get_by_role("radio", name="Stick").check()
    # A page that is opened again shows the same question.
    page.reload()
    assert question(page, arm, 1) == motion
    number = 1
    while motion is not None:
        answer(page, drag_stick, meant(person, motion))
        number += 1
        motion = question(page, arm, number)
    assert number > 3
    assert np.array_equal(stands, arm.tool), "the arm stands still all the while"

    page.get_by_role("heading", name="The robot has learned").wait_for(timeout=PATIENCE_MS)
    assert found(page) == []
    learned = arm.learning["personalise"]
    assert learned["error"] < 0.2 < learned["error_without"]
    page.get_by_role("button", name="Try it").click()
    expect(page.get_by_role("heading", name="You are trying the directions of ada.")).to_be_visible()
    assert found(page) == []
    after = straightness(page, arm, *hands)
    assert after > 0.8
    assert after > before + 0.2

    page.get_by_role("button", name="Keep it").click()
    arm.wait(lambda: arm.state["profile"] == "ada")
    arm.wait(lambda: arm.learning["profiles"] == ["ada"])
    assert [folder.name for folder in (run / "profiles").iterdir()] == ["ada"]
    page.get_by_role("button", name="Settings").click()
    expect(page.get_by_label("Your directions")).to_have_value("ada")
    page.get_by_role("button", name="Done").click()
    page.get_by_role("link", name="Personalise").click()
    page.get_by_role("heading", name="The directions of ada are kept.").wait_for()
    assert found(page) == []
