"""A study by keyboard or one switch alone, and at twice the size; axe finds nothing on its pages."""

import json
import re
import time
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page

from latentarm_research.user_studies.definition import PUBLIC_TITLE
from latentarm_research.user_studies.recorded import DATABASE
from latentarm_research.user_studies.serving.store import Store
from study_participant import MODES, SCALE, TWIST, definition, next_link, participant, serving

from .conftest import STICKS_OUT, press_switch
from .study_pages import assert_recorded, drive_trial
from .test_access import found

WITHIN_MS = 60_000
GIVEN = {
    **definition(MODES, TWIST),
    "questionnaire": [
        SCALE,
        {"name": "pain", "label": "Pain", "items": [{"text": "It hurt."}], "points": 100, "slider": True},
    ],
    "multiple_choice": [
        {"name": "used", "text": "What do you use?", "options": ["cane", "chair", "lift"], "several": True},
        {"name": "again", "text": "Once more?", "options": ["yes", "no"]},
    ],
    "comparison": [{"name": "better", "text": "Which one is better?"}],
}
ANSWERS: dict[str, int | str] = {
    **{f"ease_{number}": 6 for number in range(1, 5)}, "used": "1;3", "again": "2"
}  # fmt: skip
SLOW_LIGHT = """if (!localStorage.getItem("latentarm.settings."))
  localStorage.setItem("latentarm.settings.", JSON.stringify({ dwellS: 2.5 }));"""
"""A choice stays lit for so long that a busy computer presses in time, s."""
LOOKS = (
    {"color_scheme": "light", "forced_colors": "none"},
    {"color_scheme": "dark", "forced_colors": "none"},
    {"color_scheme": "light", "forced_colors": "active"},
    {"color_scheme": "dark", "forced_colors": "active"},
)


def looked_at(page: Page, heading: str) -> None:
    """This page is there, fits on the screen, and everybody can use it."""
    page.get_by_role("heading", name=heading).wait_for(timeout=WITHIN_MS)
    for look in LOOKS:
        page.emulate_media(**look)  # type: ignore[arg-type]
        assert found(page) == [], (heading, look)
    page.emulate_media(color_scheme="light", forced_colors="none")
    assert page.evaluate(STICKS_OUT) == []


def reach(page: Page, wanted: Locator) -> None:
    """Go on with Tab until it has the focus, and can be seen."""
    wanted.wait_for(timeout=WITHIN_MS)
    for _ in range(80):
        if wanted.evaluate("one => one === document.activeElement"):
            box = wanted.bounding_box()
            assert box is not None
            assert page.evaluate("([x, y]) => x >= 0 && y >= 0 && y <= innerHeight", [box["x"], box["y"]])
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"Tab never reaches {wanted}")


def press(page: Page, role: str, name: str, key: str = "Enter") -> None:
    reach(page, page.get_by_role(role, name=name).first)  # type: ignore[arg-type]
    page.keyboard.press(key)


def choose(page: Page, name: str) -> None:
    """Wait until it is lit, and press the switch."""
    lit = page.locator("#scan li[aria-current=true]", has_text=re.compile(name))
    lit.wait_for(timeout=WITHIN_MS)
    press_switch(page, "Enter")
    page.wait_for_timeout(150)


@pytest.fixture
def a_study(tmp_path: Path) -> tuple[str, ...]:
    """A study with one trial in each condition, and where what people do is kept."""
    study = tmp_path / "study.json"
    study.write_text(json.dumps({**GIVEN, "tasks": [{**GIVEN["tasks"][0], "trials": 1, "trial_s": 10.0}]}))
    return str(study), "--out", str(tmp_path / "people"), "--preset", "paper"


# 640 x 360 is a small laptop at 200 %.
@pytest.mark.parametrize(("width", "height"), [(1280, 720), (640, 360)])
def test_a_study_is_done_by_keyboard_alone(
    chromium: Browser, a_study: tuple[str, ...], tmp_path: Path, width: int, height: int
) -> None:
    faults: list[str] = []
    with serving(*a_study) as (link, _):
        context = chromium.new_context(viewport={"width": width, "height": height})
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(link.replace("code=", "code=0"))
        looked_at(page, "This link opens nothing")
        page.goto(link)
        looked_at(page, PUBLIC_TITLE)
        press(page, "checkbox", "I have read this", "Space")
        press(page, "button", "Take part")
        looked_at(page, "Your device")
        press(page, "button", "Check")
        looked_at(page, "Practice")
        press(page, "button", "Practise")
        page.locator("#status[data-phase=disengaged]").wait_for(timeout=WITHIN_MS)
        if page.get_by_role("button", name="Pages").is_visible():
            press(page, "button", "Pages")
        press(page, "link", "The study")
        press(page, "button", "I am ready")
        for _ in GIVEN["conditions"]:
            looked_at(page, "Marshmallows")
            press(page, "button", "Begin")
            page.locator("#status[data-phase=disengaged]").wait_for(timeout=WITHIN_MS)
            reach(page, page.locator("#stick"))
            drive_trial(page)
            looked_at(page, "How was this way of driving?")
            for item in page.locator("fieldset:not([data-options])").all():
                reach(page, item.get_by_label("1"))
                for _ in range(5):
                    page.keyboard.press("ArrowRight")
            slider = page.get_by_role("slider", name="It hurt.")
            assert slider.get_attribute("aria-valuetext") == "not answered yet"
            press(page, "slider", "It hurt.", "ArrowRight")
            assert slider.get_attribute("aria-valuetext") is None
            for option in ("cane", "lift"):
                press(page, "checkbox", option, "Space")
            press(page, "radio", "yes", "Space")
            page.keyboard.press("ArrowDown")
            press(page, "button", "Send my answers")
        looked_at(page, "All ways of driving")
        press(page, "radio", "Way of driving 1 of 2", "Space")
        press(page, "button", "Send my answers")
        looked_at(page, "Thank you")
        context.close()
    assert faults == []
    assert_recorded(tmp_path / "people", {**ANSWERS, "pain_1": 51})


def test_a_study_is_done_by_one_switch_alone(
    chromium: Browser, a_study: tuple[str, ...], tmp_path: Path
) -> None:
    faults: list[str] = []
    with serving(*a_study) as (link, _):
        page = chromium.new_page()
        page.add_init_script(SLOW_LIGHT)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(link)
        page.get_by_role("button", name="Take part").wait_for()
        page.wait_for_timeout(1000)
        press_switch(page, "Enter")
        looked_at(page, PUBLIC_TITLE)
        choose(page, "I have read this")
        choose(page, "Take part")
        looked_at(page, "Your device")
        choose(page, "^Check$")
        looked_at(page, "Practice")
        choose(page, "Practise")
        page.locator("#status[data-phase=disengaged]").wait_for(timeout=WITHIN_MS)
        for name in ("More", "Other page", "The study"):
            choose(page, name)
        choose(page, "I am ready")
        for _ in GIVEN["conditions"]:
            looked_at(page, "Marshmallows")
            choose(page, "Begin")
            page.locator("#status[data-phase=disengaged]").wait_for(timeout=WITHIN_MS)
            while not page.url.endswith("/study"):
                lit = page.locator("#scan li[aria-current=true]", has_text=re.compile("^(Enable|Up)$"))
                if lit.is_visible():
                    press_switch(page, "Enter")
                page.wait_for_timeout(100)
            looked_at(page, "How was this way of driving?")
            for number in range(1, 5):
                choose(page, f"Statement {number}")
                choose(page, "6")
            for name in ("It hurt", "More", "Back", "What do you use", "cane", "lift", "Back", "^no$"):
                choose(page, name)
            choose(page, "Send my answers")
        looked_at(page, "All ways of driving")
        for name in ("Way of driving 2 of 2", "Send my answers"):
            choose(page, name)
        looked_at(page, "Thank you")
        page.context.close()
    assert faults == []
    assert_recorded(tmp_path / "people", {**ANSWERS, "pain_1": 60})


def test_a_page_waits_in_the_queue_and_goes_on_by_itself(
    chromium: Browser, a_study: tuple[str, ...], tmp_path: Path
) -> None:
    with serving(*a_study, "--at-once", "1") as (link, _), participant(link, link) as first:
        first.consent()
        assert first.post("begin").json()["to"] == "/"
        page = chromium.new_page()
        page.goto(next_link(tmp_path / "people"))
        page.get_by_role("checkbox").check()
        page.get_by_role("button", name="Take part").click()
        page.get_by_role("button", name="Check").click()
        page.get_by_role("button", name="Practise").click()
        page.get_by_role("status").get_by_text("Yours is free in about").wait_for()
        looked_at(page, "Practice")
        # A request that is lost on the way does not end the waiting.
        with page.expect_event("requestfailed"):
            page.route("**/study/begin", lambda route: route.abort(), times=1)
        assert not page.locator(".problem").is_visible()
        first.ready()
        page.locator("#stick").wait_for(timeout=WITHIN_MS)
        page.context.close()


def test_people_who_cannot_go_on_can_leave(
    chromium: Browser, a_study: tuple[str, ...], tmp_path: Path
) -> None:
    out = tmp_path / "people"
    with serving(*a_study) as (link, _):
        first, late = chromium.new_page(), chromium.new_page()
        first.goto(link)
        late.goto(next_link(out))
        for page in (first, late):
            page.get_by_role("checkbox").check()
        first.get_by_role("button", name="Take part").click()
        first.get_by_role("heading", name="Your device").wait_for()
        # Two others come when the first person has been away for too long, and have both places.
        store, later_s = Store(out / DATABASE, away_s=0.0), time.time() + 60.0
        for name in ("one", "other"):
            key = str(store.arrive(name, "visit", later_s))
            store.consent(key, "0" * 64, "2026-01-01T00:00:00+00:00")
            assert store.place(key, later_s) is not None
        store.close()
        first.reload()
        looked_at(first, "Your place was given to somebody else")
        late.get_by_role("button", name="Take part").click()
        looked_at(late, "The study is full")
        for page in (first, late):
            page.get_by_text("Leave the study").click()
            page.get_by_role("button", name="Leave, and delete everything").click()
            looked_at(page, "You have left the study")
            page.context.close()
