"""A participant takes a study on the page, from the link to the completion code, with simulated arms."""

import json
import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route

from latentarm_research.user_studies.recorded import read_recorded
from study_participant import MODES, SCALE, TWIST, definition, participant, serving

from .conftest import STICKS_OUT
from .study_pages import drive_trial

WITHIN_MS = 60_000


def press(page: Page, name: str) -> None:
    page.get_by_role("button", name=name).click()


def looked_at(page: Page, heading: str) -> None:
    """This page is there, and fits on the screen."""
    page.get_by_role("heading", name=heading).wait_for(timeout=WITHIN_MS)
    assert page.evaluate(STICKS_OUT) == []


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (390, 844)])
def test_a_participant_takes_a_study_on_the_page(
    chromium: Browser, tmp_path: Path, width: int, height: int
) -> None:
    study, out = tmp_path / "study.json", tmp_path / "people"
    given = definition(MODES, TWIST)
    given["tasks"] = [{**given["tasks"][0], "trials": 1, "trial_s": 6.0}]
    pain = {"name": "pain", "label": "Pain", "items": [{"text": "It hurt."}], "points": 101, "slider": True}
    given["questionnaire"] = [SCALE, pain]
    study.write_text(json.dumps(given))
    with serving(str(study), "--out", str(out), "--preset", "paper", "--completion-code", "C0DE") as (
        link,
        _,
    ):
        context = chromium.new_context(viewport={"width": width, "height": height})
        page = context.new_page()
        faults: list[str] = []
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(link)
        looked_at(page, "Driving a robot arm")
        # Nobody begins without their consent.
        press(page, "Take part")
        page.get_by_role("checkbox").check()
        press(page, "Take part")
        looked_at(page, "Your device")
        press(page, "Check")
        looked_at(page, "Practice")
        press(page, "Practise")
        # The input is set up by now. The Drive page offers only what belongs to the study.
        page.locator("#status[data-phase=disengaged]").wait_for(timeout=WITHIN_MS)
        assert page.get_by_role("button", name="Settings").is_enabled()
        assert "lines" not in page.locator("#about").inner_text()  # it would tell the condition
        for foreign in ("#practice", "#poses-open", "#speed", "#task-more"):
            assert not page.locator(foreign).is_visible()
        page.go_back()
        press(page, "I am ready")
        for way in (1, 2):
            looked_at(page, "Marshmallows")
            assert page.get_by_text(f"Way of driving {way} of 2").is_visible()
            press(page, "Begin")
            page.locator("#status[data-phase=disengaged]").wait_for(timeout=WITHIN_MS)
            assert page.get_by_role("button", name="Settings are locked").is_disabled()
            page.locator("#stick").focus()
            drive_trial(page)
            looked_at(page, "How was this way of driving?")
            for item in page.locator("fieldset").all():
                item.get_by_label("6").check()
            slider = page.get_by_role("slider")
            page.get_by_text("It hurt.").click()
            assert slider.get_attribute("aria-valuetext") == "not answered yet"
            slider.click()
            assert slider.get_attribute("aria-valuetext") is None
            press(page, "Send my answers")
        looked_at(page, "Thank you")
        assert page.get_by_text("C0DE").is_visible()
        context.close()
        assert faults == []
    recorded = read_recorded(out)
    assert recorded.who == "1 real person"
    (device,) = (one.device for one in recorded.participants)
    assert (device["width_px"], device["height_px"], device["inputs"]) == (width, height, ["mouse"])
    assert re.fullmatch(r"Chrome \d+", device["browser"])
    assert 0.0 < device["round_trip_ms"] < 400.0
    assert {one.condition for one in recorded.trials} == {"Modes", "Retargeting"}
    assert all(one.measures["path_length"] > 0.0 for one in recorded.trials)
    assert [one.answer for one in recorded.answers if one.item != "pain_1"] == [6] * 8
    assert [one.answer for one in recorded.answers if one.item == "pain_1"] == [51] * 2


def test_a_browser_that_cannot_drive_says_why_and_checks_again(chromium: Browser, tmp_path: Path) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(definition(MODES, TWIST)))
    with serving(str(study), "--out", str(tmp_path / "people")) as (link, _):
        context = chromium.new_context(viewport={"width": 390, "height": 300})
        page = context.new_page()
        page.goto(link)
        page.get_by_role("checkbox").check()
        press(page, "Take part")
        looked_at(page, "Your device")
        page.evaluate("() => { HTMLCanvasElement.prototype.getContext = () => null; }")
        page.evaluate("() => { WebSocket = class extends EventTarget { close() {} }; }")
        press(page, "Check")
        for sentence in ("it has no WebGL 2", "The window is too small", "A firewall may block WebSockets"):
            page.get_by_text(sentence).wait_for(timeout=WITHIN_MS)
        looked_at(page, "Your device")
        page.set_viewport_size({"width": 390, "height": 844})
        press(page, "Check again")
        looked_at(page, "Practice")
        context.close()


def test_what_is_lost_on_the_way_can_be_sent_again(chromium: Browser, tmp_path: Path) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(definition(MODES, TWIST)))
    with serving(str(study), "--out", str(tmp_path / "people")) as (link, _):
        context = chromium.new_context()
        context.route("**/layout/words.js", lambda route: route.abort())
        context.route("**/study/consent", lambda route: route.abort(), times=1)
        context.route("**/study_device.js", lambda route: route.abort(), times=2)  # on both pages
        page = context.new_page()
        page.goto(link)
        page.get_by_role("checkbox").check()
        press(page, "Take part")
        page.get_by_text("The server cannot be reached. Try again.").wait_for(timeout=WITHIN_MS)
        assert page.get_by_role("checkbox").is_checked()
        press(page, "Take part")
        looked_at(page, "Your device")
        # Without its script the page is loaded again.
        with page.expect_event("load"):
            press(page, "Check")
        press(page, "Check")
        looked_at(page, "Practice")
        context.close()


def test_the_end_of_a_drive_reloads_the_page_once_however_slow_it_is(
    chromium: Browser, tmp_path: Path
) -> None:
    study = tmp_path / "study.json"
    study.write_text(json.dumps(definition(MODES, TWIST)))
    with (
        serving(str(study), "--out", str(tmp_path / "people")) as (link, _),
        participant(link, link) as person,
    ):
        person.consent()
        person.ready()
        context = chromium.new_context()
        context.add_cookies(
            [
                {"name": name, "value": value, "url": person.origin}
                for name, value in person.client.cookies.items()
            ]
        )
        page = context.new_page()
        page.goto(f"{person.origin}/study")
        press(page, "Begin")
        page.locator("#status[data-phase=disengaged]").wait_for(timeout=WITHIN_MS)
        loads: list[str] = []

        def slowly(route: Route) -> None:
            loads.append(route.request.url)
            page.wait_for_timeout(4000)
            route.continue_()

        context.route(f"{person.origin}/", slowly)
        page.locator("#stick").focus()
        drive_trial(page)
        looked_at(page, "How was this way of driving?")
        context.close()
    assert len(loads) == 1
